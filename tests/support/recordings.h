#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/capture/gray_image.h"
#include "core/geometry/stamp.h"

namespace waymark::test {

/// Bytes in the order in which recorders write them.
class Bytes {
 public:
  explicit Bytes(bool big_endian = false) : big_endian_(big_endian) {}

  template <typename Number>
  Bytes& number(Number value) {
    const char* const raw = reinterpret_cast<const char*>(&value);  // NOLINT: bytes of a number
    for (std::size_t i = 0; i < sizeof value; ++i) {
      text_ += raw[big_endian_ ? sizeof value - 1 - i : i];
    }
    return *this;
  }
  Bytes& raw(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  /// Its length in 32 bits before it.
  Bytes& text(std::string_view bytes) {
    return number(static_cast<std::uint32_t>(bytes.size())).raw(bytes);
  }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  bool big_endian_;
  std::string text_;
};

/// Its own serializer of ROS 2 messages.
class Cdr {
 public:
  explicit Cdr(bool big_endian = false)
      : big_endian_(big_endian),
        header_(big_endian ? std::string(4, '\0') : std::string("\0\1\0\0", 4)) {}

  template <typename Number>
  Cdr& number(Number value) {
    body_.append((sizeof value - body_.size() % sizeof value) % sizeof value, '\0');
    body_ += Bytes(big_endian_).number(value).str();
    return *this;
  }
  Cdr& text(const std::string& text) {
    number(static_cast<std::uint32_t>(text.size() + 1));
    body_ += text + '\0';
    return *this;
  }
  Cdr& bytes(std::string_view bytes) {
    number(static_cast<std::uint32_t>(bytes.size()));
    body_ += bytes;
    return *this;
  }
  Cdr& header(Stamp stamp) {
    number(static_cast<std::int32_t>(stamp.count() / 1'000'000'000));
    number(static_cast<std::uint32_t>(stamp.count() % 1'000'000'000));
    return text("camera_link");
  }
  [[nodiscard]] std::string str() const { return header_ + body_; }

 private:
  bool big_endian_;
  std::string header_;
  std::string body_;
};

struct RecordedMessage {
  std::string topic;
  std::string type;
  std::string data;
};

/// sensor_msgs/msg/Image of any encoding; `data` rows of `step` bytes.
[[nodiscard]] RecordedMessage raw_image(const std::string& topic, Stamp stamp, std::uint32_t width,
                                        std::uint32_t height, const std::string& encoding,
                                        std::uint32_t step, std::string_view data);
/// The same of a grey image, as mono8.
[[nodiscard]] RecordedMessage raw_image(const std::string& topic, Stamp stamp,
                                        const GrayImage& image);
[[nodiscard]] RecordedMessage compressed_image(const std::string& topic, Stamp stamp,
                                               const std::string& format, std::string_view file);
/// A calibrated camera: f in both directions, axis in the middle, no distortion.
[[nodiscard]] RecordedMessage camera_info(const std::string& topic, std::uint32_t width,
                                          std::uint32_t height, double focal_px,
                                          std::uint32_t binning = 0);

/// How an MCAP file is written.
struct McapForm {
  std::string compression;  ///< "", "lz4" or "zstd"
  std::size_t chunk = 3;    ///< messages in each; 0: no chunks
  bool checksums = true;
};
[[nodiscard]] std::string mcap_of(const std::vector<RecordedMessage>& messages,
                                  const McapForm& form = {});
/// One record of it.
[[nodiscard]] std::string mcap_record(std::uint8_t op, std::string_view content);
/// A chunk of records, whatever it is said to unpack to.
[[nodiscard]] std::string mcap_chunk(const std::string& records, const McapForm& form,
                                     std::uint64_t stated_bytes);
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};

/// rosbag2's other storage.
void write_sqlite_bag(const std::filesystem::path& path,
                      const std::vector<RecordedMessage>& messages);
/// A database of any content.
void write_sqlite(const std::filesystem::path& path, const std::string& statements);

[[nodiscard]] std::string zstd_of(std::string_view bytes, int window_log = 0);
[[nodiscard]] std::string lz4_of(std::string_view bytes);

}  // namespace waymark::test
