#include "mapbuilder/upkeep/map_info.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/base/atomic_file.h"
#include "core/base/is_there.h"
#include "core/map/map_file.h"
#include "mapbuilder/upkeep/joined_system.h"

namespace waymark {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "WAYINFO\n";
constexpr std::size_t kHashAt = 8;
constexpr std::size_t kBodyAt = 16;
/// A hundred thousand markers with a hundred neighbours each.
constexpr std::size_t kMaxBytes = std::size_t{1} << 32;

template <typename T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Reads values one behind the other; fails for good at the end of the bytes.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  bool take(T& value) {
    if (bytes_.size() < sizeof value) return false;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return true;
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

std::uint64_t hash_of(std::string_view body) { return XXH3_64bits(body.data(), body.size()); }

/// Whether the blocks can be parts of an information matrix: diagonals of no sigma below a
/// picometre, symmetric, and no element larger than its two diagonal ones allow (|m_ij|² ≤ m_ii
/// m_jj).
bool can_be_information(const MarkerSystem& system) {
  constexpr double kMost = 1e24;
  constexpr double kRounding = 1e-6;  // of the largest
  std::vector<Vector6d> diagonals;
  double largest = 0;
  for (const auto& [at, block] : system.blocks) {
    if (at.first != at.second) continue;
    diagonals.push_back(block.diagonal());
    largest = std::max(largest, block.diagonal().maxCoeff());
  }
  if (largest > kMost) return false;
  for (const auto& [at, block] : system.blocks) {
    const Vector6d rows = diagonals[static_cast<std::size_t>(at.first)].cwiseMax(0).cwiseSqrt();
    const Vector6d columns = diagonals[static_cast<std::size_t>(at.second)].cwiseMax(0).cwiseSqrt();
    const Matrix6d most = (rows * columns.transpose()).array() + kRounding * largest;
    if (!(block.array().abs() <= most.array()).all()) return false;
    if (at.first == at.second &&
        (block - block.transpose()).cwiseAbs().maxCoeff() > kRounding * largest) {
      return false;
    }
  }
  return true;
}

bool read_system(ByteReader& reader, const SubMap& submap, MarkerSystem& system) {
  std::uint32_t markers = 0;
  std::uint32_t blocks = 0;
  if (!reader.take(markers) || !reader.take(blocks)) return false;
  if (markers == 0) return blocks == 0;
  if (markers != submap.markers.size()) return false;
  for (const MapMarker& marker : submap.markers) {
    system.world_from_marker.push_back(marker.world_from_marker);
  }
  std::uint32_t diagonals = 0;
  for (std::uint32_t b = 0; b < blocks; ++b) {
    std::uint32_t row = 0;
    std::uint32_t column = 0;
    if (!reader.take(row) || !reader.take(column) || row >= markers || column > row) return false;
    Matrix6d block;
    for (double& value : block.reshaped()) {
      if (!reader.take(value) || !std::isfinite(value)) return false;
    }
    diagonals += row == column ? 1 : 0;
    const std::pair at{static_cast<int>(row), static_cast<int>(column)};
    if (!system.blocks.emplace(at, block).second) return false;
  }
  return diagonals == markers && can_be_information(system);
}

}  // namespace

Status write_map_info(const std::filesystem::path& map_path, const MarkerMap& map,
                      const std::vector<MarkerSystem>& systems) {
  std::string body = content_hash(map);
  put(body, static_cast<std::uint32_t>(systems.size()));
  for (const MarkerSystem& system : systems) {
    put(body, static_cast<std::uint32_t>(system.markers()));
    put(body, static_cast<std::uint32_t>(system.blocks.size()));
    for (const auto& [at, block] : system.blocks) {
      put(body, static_cast<std::uint32_t>(at.first));
      put(body, static_cast<std::uint32_t>(at.second));
      for (const double value : block.reshaped()) put(body, value);
    }
  }
  std::string bytes(kMagic);
  put(bytes, hash_of(body));
  return write_file_atomically(info_path(map_path), bytes + body);
}

Status write_info_of_build(const std::filesystem::path& map_path, const Observations& observations,
                           const BuildResult& result, const BuildOptions& options) {
  if (!options.survey.empty() || result.calibration.refined) return {};
  const RoundParts parts(observations, result, options);
  return write_map_info(map_path, result.map, systems_of_build(parts));
}

Expected<std::optional<std::vector<MarkerSystem>>> read_map_info(
    const std::filesystem::path& map_path, const MarkerMap& map) {
  using Systems = std::vector<MarkerSystem>;
  const std::filesystem::path path = info_path(map_path);
  if (!is_there(path)) return std::optional<Systems>();
  const auto bytes = read_file(path, kMaxBytes);
  if (!bytes) return tl::make_unexpected(bytes.error());
  const auto damaged = [&] {
    return fail(ErrorKind::bad_data,
                "{}: damaged; remove it, and the map's markers are taken as independent",
                path.string());
  };
  if (!bytes->starts_with(kMagic) || bytes->size() < kBodyAt) return damaged();
  const std::string_view body = std::string_view(*bytes).substr(kBodyAt);
  std::uint64_t hash = 0;
  std::memcpy(&hash, bytes->data() + kHashAt, sizeof hash);
  const std::string of_map = content_hash(map);
  if (hash != hash_of(body) || body.size() < of_map.size()) return damaged();
  if (!body.starts_with(of_map)) return std::optional<Systems>();
  ByteReader reader(body.substr(of_map.size()));
  std::uint32_t submaps = 0;
  if (!reader.take(submaps) || submaps != map.submaps.size()) return damaged();
  Systems systems(submaps);
  for (std::size_t s = 0; s < systems.size(); ++s) {
    if (!read_system(reader, map.submaps[s], systems[s])) return damaged();
  }
  if (reader.left() != 0) return damaged();
  return std::optional(std::move(systems));
}

}  // namespace waymark
