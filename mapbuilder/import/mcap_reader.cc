#include "mapbuilder/import/mcap_reader.h"

#include <zlib.h>

#include <array>
#include <map>

#include "mapbuilder/import/byte_cursor.h"
#include "mapbuilder/import/byte_source.h"
#include "mapbuilder/import/unpacked_source.h"

namespace waymark {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

/// Kinds of records; those that are not named here are passed over.
enum class Op : std::uint8_t {
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
};

/// Bytes with their CRC-32 as they pass.
class ChecksumSource : public ByteSource {
 public:
  explicit ChecksumSource(ByteSource& source) : source_(source) {}

  Expected<std::size_t> read(std::span<std::uint8_t> buffer) override {
    const auto got = source_.read(buffer);
    if (got) checksum_ = ::crc32_z(checksum_, buffer.data(), *got);
    return got;
  }
  [[nodiscard]] std::uint32_t checksum() const { return static_cast<std::uint32_t>(checksum_); }

 private:
  ByteSource& source_;
  uLong checksum_ = 0;
};

/// What stands before a chunk's records.
struct ChunkHead {
  std::uint64_t unpacked_bytes = 0;
  std::uint32_t checksum = 0;  ///< 0: none
  std::string compression;
  std::uint64_t packed_bytes = 0;
};

/// A chunk while its records are read. The first of these sources is the file's part, the last
/// gives records.
struct Chunk {
  Chunk(ByteSource& file, const ChunkHead& stated)
      : head(stated),
        packed(file, stated.packed_bytes),
        unpacked(unpacker(packed, stated.compression)),
        checked(unpacked ? *unpacked : static_cast<ByteSource&>(packed)),
        records(checked, stated.unpacked_bytes) {}

  static std::unique_ptr<ByteSource> unpacker(ByteSource& packed, const std::string& compression) {
    if (compression == "zstd") return unpacked_zstd(packed);
    if (compression == "lz4") return unpacked_lz4(packed);
    return nullptr;
  }

  ChunkHead head;
  PartSource packed;
  std::unique_ptr<ByteSource> unpacked;  ///< null: stored as they are
  ChecksumSource checked;
  PartSource records;
};

class McapReader : public BagReader {
 public:
  McapReader(std::string name, InputFile file, WantsTopic wants)
      : name_(std::move(name)), file_(std::move(file)), wants_(std::move(wants)) {}

  Status read_magic() {
    std::array<std::uint8_t, kMagic.size()> bytes{};
    const auto whole = read_whole(file_, bytes);
    if (!whole) return tl::make_unexpected(whole.error());
    if (*whole && std::equal(bytes.begin(), bytes.end(), kMagic.begin(), same_byte)) return {};
    return fail(ErrorKind::bad_data, "{}: not an MCAP file of version 0", name_);
  }

  Expected<std::optional<BagMessage>> next() override {
    while (!at_end_) {
      auto message = next_record();
      if (!message || *message) return message;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::uintmax_t position() const override { return file_.position(); }

 private:
  struct Channel {
    BagTopic topic;
    bool wanted = false;
  };
  using Nothing = std::optional<BagMessage>;  // what records that are no message give

  static bool same_byte(std::uint8_t byte, char expected) {
    return byte == static_cast<std::uint8_t>(expected);
  }

  [[nodiscard]] tl::unexpected<Error> damaged(std::string_view why) const {
    return fail(ErrorKind::bad_data, "{}: damaged MCAP file before byte {}: {}", name_,
                file_.position(), why);
  }
  [[nodiscard]] tl::unexpected<Error> truncated() const {
    return fail(
        ErrorKind::bad_data,
        "{}: truncated MCAP file: it ends at byte {} within a record; mcap recover makes one "
        "of what is whole",
        name_, file_.size());
  }

  /// What a chunk's own reads say names no file.
  [[nodiscard]] tl::unexpected<Error> about(const Error& error) const {
    if (!chunk_) return tl::make_unexpected(error);
    return damaged(error.message);
  }

  [[nodiscard]] ByteSource& source() {
    return chunk_ ? static_cast<ByteSource&>(chunk_->records) : file_;
  }
  /// Bytes that may follow where records are read now.
  [[nodiscard]] std::uint64_t left() const {
    if (chunk_) return chunk_->records.left();
    return file_.size() - std::min(file_.size(), file_.position());
  }

  Status fill(std::span<std::uint8_t> buffer) {
    const auto whole = read_whole(source(), buffer);
    if (!whole) return about(whole.error());
    if (*whole) return {};
    if (chunk_) return damaged("a chunk holds less than it states");
    return truncated();
  }

  Status skip(std::uint64_t count) {
    const auto whole = pass_over(source(), count);
    if (!whole) return about(whole.error());
    if (*whole) return {};
    if (chunk_) return damaged("a chunk holds less than it states");
    return truncated();
  }

  Expected<Nothing> next_record() {
    if (chunk_ && chunk_->records.left() == 0) return end_chunk();
    std::array<std::uint8_t, 9> head{};
    if (auto filled = fill(head); !filled) return tl::make_unexpected(filled.error());
    ByteCursor cursor(head, std::endian::little);
    const auto op = static_cast<Op>(cursor.number<std::uint8_t>());
    const auto size = cursor.number<std::uint64_t>();
    if (size > left()) {
      if (chunk_) return damaged("a record reaches beyond its chunk");
      return truncated();
    }
    switch (op) {
      case Op::schema:
        return nothing_after(take_schema(size));
      case Op::channel:
        return nothing_after(take_channel(size));
      case Op::message:
        return take_message(size);
      case Op::chunk:
        return nothing_after(begin_chunk(size));
      case Op::footer:
        return nothing_after(take_footer(size));
    }
    return nothing_after(skip(size));
  }

  static Expected<Nothing> nothing_after(const Status& status) {
    if (!status) return tl::make_unexpected(status.error());
    return Nothing{};
  }

  /// The first bytes of a record that may be long; the rest is passed over.
  Expected<std::span<const std::uint8_t>> take_front(std::uint64_t size) {
    constexpr std::uint64_t kFront = 4096;
    front_.resize(std::min(size, kFront));
    if (auto filled = fill(front_); !filled) return tl::make_unexpected(filled.error());
    if (auto skipped = skip(size - front_.size()); !skipped) {
      return tl::make_unexpected(skipped.error());
    }
    return front_;
  }

  static std::string text(ByteCursor& cursor) {
    const auto size = cursor.number<std::uint32_t>();
    return std::string(cursor.text(size));
  }

  Status take_schema(std::uint64_t size) {
    const auto front = take_front(size);
    if (!front) return tl::make_unexpected(front.error());
    ByteCursor cursor(*front, std::endian::little);
    const auto id = cursor.number<std::uint16_t>();
    std::string type = text(cursor);
    if (cursor.failed() || type.size() > BagLimits::kLongestName) return damaged("a schema's name");
    if (types_.size() == BagLimits::kMostTopics) return damaged("too many schemas");
    types_[id] = std::move(type);
    return {};
  }

  Status take_channel(std::uint64_t size) {
    const auto front = take_front(size);
    if (!front) return tl::make_unexpected(front.error());
    ByteCursor cursor(*front, std::endian::little);
    const auto id = cursor.number<std::uint16_t>();
    const auto type = types_.find(cursor.number<std::uint16_t>());
    BagTopic topic;
    topic.name = text(cursor);
    topic.encoding = text(cursor);
    if (type != types_.end()) topic.type = type->second;
    if (cursor.failed() || topic.name.size() > BagLimits::kLongestName ||
        topic.encoding.size() > BagLimits::kLongestName) {
      return damaged("a channel's name");
    }
    if (channels_.size() == BagLimits::kMostTopics) return damaged("too many channels");
    const bool wanted = wants_(topic);
    channels_.try_emplace(id, Channel{std::move(topic), wanted});
    return {};
  }

  Expected<Nothing> take_message(std::uint64_t size) {
    std::array<std::uint8_t, 22> head{};
    if (size < head.size()) return damaged("a message's head");
    if (auto filled = fill(head); !filled) return tl::make_unexpected(filled.error());
    ByteCursor cursor(head, std::endian::little);
    const auto channel = channels_.find(cursor.number<std::uint16_t>());
    if (channel == channels_.end()) return damaged("a message of a channel that is not told");
    const std::uint64_t bytes = size - head.size();
    if (!channel->second.wanted) return nothing_after(skip(bytes));
    if (bytes > BagLimits::largest_message(file_.size())) {
      return damaged(fmt::format("a message of {} bytes", bytes));
    }
    data_.resize(bytes);
    if (auto filled = fill(data_); !filled) return tl::make_unexpected(filled.error());
    return Nothing{BagMessage{&channel->second.topic, data_}};
  }

  Status begin_chunk(std::uint64_t size) {
    if (chunk_) return damaged("a chunk within a chunk");
    std::array<std::uint8_t, 32> fixed{};
    if (size < fixed.size()) return damaged("a chunk's head");
    if (auto filled = fill(fixed); !filled) return filled;
    ByteCursor cursor(std::span<const std::uint8_t>(fixed).subspan(16), std::endian::little);
    ChunkHead head;
    head.unpacked_bytes = cursor.number<std::uint64_t>();
    head.checksum = cursor.number<std::uint32_t>();
    const auto name_bytes = cursor.number<std::uint32_t>();
    if (name_bytes > 16 || size < fixed.size() + name_bytes + 8) return damaged("a chunk's head");
    std::array<std::uint8_t, 24> rest{};
    if (auto filled = fill(std::span(rest).first(name_bytes + 8)); !filled) return filled;
    ByteCursor behind(rest, std::endian::little);
    head.compression = behind.text(name_bytes);
    head.packed_bytes = behind.number<std::uint64_t>();
    if (head.packed_bytes != size - fixed.size() - name_bytes - 8) return damaged("a chunk's size");
    return check_and_enter(head);
  }

  Status check_and_enter(const ChunkHead& head) {
    const std::string& compression = head.compression;
    if (!compression.empty() && compression != "zstd" && compression != "lz4") {
      return damaged(fmt::format("compression \"{}\", which is not known", compression));
    }
    if (compression.empty() && head.unpacked_bytes != head.packed_bytes) {
      return damaged("a chunk's size");
    }
    const std::uintmax_t most = BagLimits::most_unpacked(file_.size());
    if (head.unpacked_bytes > most - unpacked_) {
      return damaged(fmt::format("it unpacks to more than {} bytes", most));
    }
    unpacked_ += head.unpacked_bytes;
    chunk_ = std::make_unique<Chunk>(file_, head);
    return {};
  }

  Expected<Nothing> end_chunk() {
    const std::uint32_t stated = chunk_->head.checksum;
    if (stated != 0 && stated != chunk_->checked.checksum()) {
      return damaged("a chunk's checksum is another one than stated");
    }
    const std::uint64_t rest = chunk_->packed.left();
    chunk_.reset();
    return nothing_after(skip(rest));
  }

  /// The file's last record; behind it stands what it began with.
  Status take_footer(std::uint64_t size) {
    if (chunk_) return damaged("a footer within a chunk");
    if (auto skipped = skip(size); !skipped) return skipped;
    std::array<std::uint8_t, kMagic.size()> bytes{};
    if (auto filled = fill(bytes); !filled) return filled;
    if (!std::equal(bytes.begin(), bytes.end(), kMagic.begin(), same_byte)) {
      return damaged("its end is none");
    }
    at_end_ = true;
    return {};
  }

  std::string name_;
  FileSource file_;
  WantsTopic wants_;
  std::map<std::uint16_t, std::string> types_;
  std::map<std::uint16_t, Channel> channels_;
  std::unique_ptr<Chunk> chunk_;  ///< whose records are read now
  std::uintmax_t unpacked_ = 0;   ///< bytes of all chunks so far
  bool at_end_ = false;
  std::vector<std::uint8_t> front_;
  std::vector<std::uint8_t> data_;
};

}  // namespace

Expected<std::unique_ptr<BagReader>> open_mcap(const std::filesystem::path& path,
                                               WantsTopic wants) {
  auto file = InputFile::open(path, BagLimits::kLargestFile);
  if (!file) return tl::make_unexpected(file.error());
  auto reader = std::make_unique<McapReader>(path.string(), std::move(*file), std::move(wants));
  if (auto begun = reader->read_magic(); !begun) return tl::make_unexpected(begun.error());
  return reader;
}

}  // namespace waymark
