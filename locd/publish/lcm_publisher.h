#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/priority_mutex.h"
#include "core/geometry/stamp.h"
#include "locd/publish/lcm_url.h"

namespace waymark {

/// Sends messages over LCM and never lets it stop anything: an address that can't be reached is
/// tried again with back-off, a network that takes no packets is not waited for, a message that is
/// not taken is counted, and nothing else takes LCM's place. Any thread may publish; nothing is
/// ever received.
class LcmPublisher {
 public:
  static constexpr Stamp kFirstRetry = std::chrono::milliseconds(500);
  static constexpr Stamp kLongestRetry = std::chrono::seconds(8);
  /// Sending failed for so long: the socket is made anew. Not one that is full: its packets would
  /// only wait twice.
  static constexpr Stamp kRenew = std::chrono::seconds(5);
  /// A larger message is not sent. LCM's own limit for one packet is far above this.
  static constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 18;

  /// Why messages are not taken.
  enum class Link : std::uint8_t {
    up,
    no_route,     ///< for the group
    full,         ///< the network takes no packets: what is under way fills the socket's buffer
    not_allowed,  ///< the unit, or a firewall, lets no packet out to this group
    too_large,    ///< the message is larger than kMaxMessageBytes
    failing,      ///< whatever else
  };

  /// Makes the first attempt at once. `url` is one that parse_lcm_url accepts.
  LcmPublisher(std::string_view url, Stamp now);

  /// Encodes and hands to LCM; false, and counted, when LCM is not there or does not take it.
  template <typename Message>
  bool publish(const std::string& channel, const Message& message, Stamp now) {
    const std::lock_guard lock(mutex_);
    const int size = message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
    if (size < 0) return refuse(Link::too_large);
    return send(channel, static_cast<unsigned>(size), now);
  }

  /// Messages that LCM did not take.
  [[nodiscard]] std::int64_t failures() const;
  /// How it was with the last message that was not taken; up before the first.
  [[nodiscard]] Link last_failure() const;
  /// Where messages go.
  [[nodiscard]] const LcmUrl& address() const { return url_; }

  /// LCM itself, for a subscriber in the same process (memq://); null while there is none.
  [[nodiscard]] lcm::LCM* lcm() { return lcm_.get(); }

 private:
  void connect(Stamp now);
  [[nodiscard]] bool send(const std::string& channel, unsigned size, Stamp now);
  /// Counts it; false.
  bool refuse(Link why);

  const LcmUrl url_;
  mutable PriorityMutex mutex_;  ///< localization, on SCHED_FIFO, publishes too
  std::unique_ptr<lcm::LCM> lcm_;
  std::vector<std::uint8_t> buffer_;
  Stamp retry_at_{0};
  Stamp retry_after_ = kFirstRetry;
  Stamp failing_since_{0};
  bool last_taken_ = false;
  Link last_failure_ = Link::up;
  std::int64_t failures_ = 0;
};

/// Why, and what to do about it, in words: "the network takes no packets; …".
[[nodiscard]] std::string describe(LcmPublisher::Link link, const LcmUrl& address);

}  // namespace waymark
