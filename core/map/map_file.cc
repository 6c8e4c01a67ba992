#include "core/map/map_file.h"

#include <xxhash.h>

#include <array>

#include "core/base/atomic_file.h"
#include "core/base/check.h"
#include "core/map/map_check.h"
#include "core/map/map_records.h"

namespace waymark {
namespace {

constexpr std::string_view kMagic = "WAYMARK\n";
constexpr std::size_t kVersionAt = 8;
constexpr std::size_t kLengthAt = 12;
constexpr std::size_t kCrcAt = 20;
constexpr std::size_t kHeaderSize = 24;
/// Twenty times the largest warehouse: 400,000 markers. What is larger is no map.
constexpr std::size_t kMaxBytes = std::size_t{1} << 28;

/// `size` bytes of `value`, lowest first.
std::string little_endian(std::uint64_t value, std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  return bytes;
}

std::uint64_t from_little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = value << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

/// What one byte contributes to a CRC32C: its remainder by Castagnoli's polynomial, bits reflected.
constexpr std::array<std::uint32_t, 256> kCrcOfByte = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = remainder >> 1 ^ ((remainder & 1) != 0 ? 0x82F6'3B78U : 0U);
    }
    table[byte] = remainder;
  }
  return table;
}();

/// CRC32C (Castagnoli) over the header before its CRC field and the payload.
std::uint32_t checksum(std::string_view fields, std::string_view payload) {
  std::uint32_t crc = 0xFFFF'FFFF;
  for (const std::string_view part : {fields, payload}) {
    for (const char byte : part) {
      crc = crc >> 8 ^ kCrcOfByte[(crc ^ static_cast<unsigned char>(byte)) & 0xFF];
    }
  }
  return ~crc;
}

struct Container {
  std::uint32_t version = 0;
  std::string_view payload;
};

/// A container whose every byte is as it was written.
Expected<Container> open_container(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kMagic)) {
    return fail(ErrorKind::bad_data,
                "{}: no marker map: it does not begin with \"WAYMARK\"; maps are what mapbuilder "
                "build and import write",
                name);
  }
  if (bytes.size() < kHeaderSize) {
    return fail(ErrorKind::bad_data, "{}: truncated marker map: {} bytes; copy the file again",
                name, bytes.size());
  }
  const std::uint64_t version = from_little_endian(bytes.substr(kVersionAt, 4));
  if (version > kMapContainerVersion) {
    return fail(ErrorKind::bad_data,
                "{}: marker map of version {}, newer than version {} which this program reads; "
                "update Waymark here or build the map with this version",
                name, version, kMapContainerVersion);
  }
  if (version == 0) {
    return fail(ErrorKind::bad_data, "{}: damaged marker map: version 0; copy the file again",
                name);
  }
  const std::uint64_t length = from_little_endian(bytes.substr(kLengthAt, 8));
  const std::string_view payload = bytes.substr(kHeaderSize);
  if (payload.size() != length) {
    return fail(ErrorKind::bad_data,
                "{}: {} marker map: {} bytes instead of {} after the header; copy the file again",
                name, payload.size() < length ? "truncated" : "damaged", payload.size(), length);
  }
  if (from_little_endian(bytes.substr(kCrcAt, 4)) != checksum(bytes.substr(0, kCrcAt), payload)) {
    return fail(ErrorKind::bad_data,
                "{}: damaged marker map: its checksum does not fit; copy the file again", name);
  }
  return Container{static_cast<std::uint32_t>(version), payload};
}

}  // namespace

Expected<std::string> encode_map(const MarkerMap& map) {
  if (const auto status = check_map(map); !status) {
    return fail(ErrorKind::internal, "a map that can't be written was built: {}",
                status.error().message);
  }
  const std::string payload = encode_records(map);
  std::string bytes(kMagic);
  bytes += little_endian(record_version(map), 4);
  bytes += little_endian(payload.size(), 8);
  bytes += little_endian(checksum(bytes, payload), 4);
  return bytes + payload;
}

Expected<MarkerMap> decode_map(std::string_view bytes, const std::string& name) {
  const auto container = open_container(bytes, name);
  if (!container) return tl::make_unexpected(container.error());
  auto map = decode_records(container->payload, container->version);
  const Status status = map ? check_map(*map) : tl::make_unexpected(map.error());
  if (!status) {
    return fail(ErrorKind::bad_data, "{}: marker map that makes no sense: {}; build it again", name,
                status.error().message);
  }
  return map;
}

Status write_map_file(const std::filesystem::path& path, const MarkerMap& map) {
  const auto bytes = encode_map(map);
  if (!bytes) return tl::make_unexpected(bytes.error());
  return write_file_atomically(path, *bytes);
}

Expected<MarkerMap> read_map_file(const std::filesystem::path& path) {
  const auto bytes = read_file(path, kMaxBytes);
  if (!bytes) return tl::make_unexpected(bytes.error());
  return decode_map(*bytes, path.string());
}

std::string content_hash(const MarkerMap& map) {
  WAYMARK_CHECK(check_map(map).has_value());
  const std::string payload = encode_records(map);
  return fmt::format("{:016x}", XXH3_64bits(payload.data(), payload.size()));
}

}  // namespace waymark
