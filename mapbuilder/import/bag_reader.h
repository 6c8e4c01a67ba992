#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace waymark {

/// A topic of a recording of ROS 2.
struct BagTopic {
  std::string name;      ///< "/left/image_raw"
  std::string type;      ///< "sensor_msgs/msg/Image"
  std::string encoding;  ///< of its messages: "cdr"
};

/// One recorded message.
struct BagMessage {
  const BagTopic* topic = nullptr;     ///< of the reader, valid as long as it
  std::span<const std::uint8_t> data;  ///< serialized; valid until the next call
};

/// Which topics' messages are wanted; those of others are passed over unread.
using WantsTopic = std::function<bool(const BagTopic&)>;

/// The messages of a recorded file, in the order in which they were written.
class BagReader {
 public:
  BagReader() = default;
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;
  virtual ~BagReader() = default;

  /// The next message of a topic that is wanted; nullopt behind the last. bad_data where the file
  /// is damaged or truncated, or what it unpacks to is beyond its limits; io.
  [[nodiscard]] virtual Expected<std::optional<BagMessage>> next() = 0;

  /// Bytes of the file that are read, about.
  [[nodiscard]] virtual std::uintmax_t position() const = 0;
};

/// What the files of recordings are bounded by.
struct BagLimits {
  static constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 42;
  static constexpr std::size_t kLongestName = 256;  ///< of a topic, a type, an encoding
  static constexpr std::size_t kMostTopics = 4096;

  /// The largest message that a file of so many bytes may hold, unpacked.
  static std::size_t largest_message(std::uintmax_t file_bytes) {
    return static_cast<std::size_t>(24'000'000 + 5 * file_bytes);
  }
  /// To how much a file of so many bytes may unpack in all: lz4 knows no more than 255 to 1.
  static std::uintmax_t most_unpacked(std::uintmax_t file_bytes) {
    return 64'000'000 + 255 * file_bytes;
  }
};

}  // namespace waymark
