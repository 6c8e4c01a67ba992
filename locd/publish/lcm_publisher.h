#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/check.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// Sends messages over LCM and never lets it stop anything: an address that can't be reached is
/// tried again with back-off, a message that is not taken is counted, and nothing else takes LCM's
/// place. Any thread may publish; nothing is ever received.
class LcmPublisher {
 public:
  static constexpr Stamp kFirstRetry = std::chrono::milliseconds(500);
  static constexpr Stamp kLongestRetry = std::chrono::seconds(8);
  /// Sending failed for so long: the socket is made anew.
  static constexpr Stamp kRenew = std::chrono::seconds(5);
  /// LCM's own limit for a message in one packet is far above this; ours are smaller.
  static constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 18;

  /// Makes the first attempt at once. `url` is one that lcm_ttl accepts.
  LcmPublisher(std::string url, Stamp now);

  /// Encodes and hands to LCM; false, and counted, when LCM is not there or does not take it.
  template <typename Message>
  bool publish(const std::string& channel, const Message& message, Stamp now) {
    const std::lock_guard lock(mutex_);
    const int size = message.getEncodedSize();
    WAYMARK_CHECK(size >= 0 && static_cast<std::size_t>(size) <= buffer_.size());
    WAYMARK_CHECK(message.encode(buffer_.data(), 0, size) == size);
    return send(channel, static_cast<unsigned>(size), now);
  }

  /// Messages that LCM did not take.
  [[nodiscard]] std::int64_t failures() const;
  /// The last message was taken, or none was published and LCM is there.
  [[nodiscard]] bool connected() const;

  /// LCM itself, for a subscriber in the same process (memq://); null while there is none.
  [[nodiscard]] lcm::LCM* lcm() { return lcm_.get(); }

 private:
  void connect(Stamp now);
  [[nodiscard]] bool send(const std::string& channel, unsigned size, Stamp now);

  const std::string url_;
  mutable std::mutex mutex_;
  std::unique_ptr<lcm::LCM> lcm_;
  std::vector<std::uint8_t> buffer_;
  Stamp retry_at_{0};
  Stamp retry_after_ = kFirstRetry;
  Stamp failing_since_{0};
  bool last_taken_ = false;
  std::int64_t failures_ = 0;
};

}  // namespace waymark
