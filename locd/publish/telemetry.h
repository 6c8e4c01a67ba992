#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <waymark/status_t.hpp>

#include "core/base/priority_mutex.h"
#include "locd/publish/clock_offset.h"
#include "locd/publish/lcm_options.h"
#include "locd/publish/lcm_publisher.h"
#include "locd/publish/message_key.h"
#include "locd/publish/messages.h"

namespace waymark {

/// All that locd says to the world: numbers its messages, keeps utime, and sees to it that a pose
/// goes out at least every 0.5 s. Any thread; each call holds the lock for the time of one encoding
/// and one send.
class Telemetry {
 public:
  /// Without a pose for so long, one is published that says so; less than 0.5 s by what a thread
  /// may wake up late.
  static constexpr Stamp kHeartbeat = std::chrono::milliseconds(450);

  /// With a key poses are signed besides. The channels' prefix is_channel_prefix (checked).
  Telemetry(const LcmOptions& lcm, SessionFacts session, const ClockReading& now,
            std::optional<MessageKey> key = std::nullopt);

  /// Publishes the pose of a set (and its detections, where configured); allocates nothing. Gives
  /// what made its utime of its stamp.
  Stamp publish_pose(const PoseEstimate& estimate, Stamp now);
  /// Publishes LOST when the last pose is old; `why` there is none.
  void keep_alive(Stamp now, PoseReason why);
  /// When keep_alive is to be called, unless a pose is published before.
  [[nodiscard]] Stamp next_keep_alive() const;
  /// `map`: the one that it was found with.
  void publish_alert(const Alert& alert, const Rig& rig, const MapIdentity& map, Stamp now);
  /// An alert of the service itself: RELOAD, RECORDING, TIME …
  void publish_alert(const std::string& kind, const std::string& subject, const std::string& text,
                     bool raised, Stamp now);
  /// How the poses since the last call were: "OK 97 % of 30/s, 14 markers, 3 mm; DEGRADED: cam1
  /// missing", the last of each kind.
  [[nodiscard]] std::string take_pose_summary(Stamp interval);
  /// Fills in what only this class knows (times, poses, latency, failures) and publishes.
  void publish_status(status_t& status, Stamp now);

  /// Another map from now on.
  void set_map(const MapIdentity& map);
  /// Follows the machine's clocks; what has happened to them since the last call.
  ClockEvent follow_clocks(const ClockReading& now);

  [[nodiscard]] SessionFacts session() const;
  /// What utime adds to a stamp.
  [[nodiscard]] Stamp utime_offset() const;
  /// Whether utime surely is the date.
  [[nodiscard]] bool date_known() const;
  /// µs since the epoch of a stamp.
  [[nodiscard]] std::int64_t utime_us(Stamp stamp) const;
  /// Where messages go, how many did not, and why the last did not.
  [[nodiscard]] const LcmPublisher& publisher() const { return publisher_; }
  /// LCM itself, for a subscriber in this process (memq://).
  [[nodiscard]] lcm::LCM* lcm() { return publisher_.lcm(); }

 private:
  /// Latencies of up to so many poses within a second are judged.
  static constexpr std::size_t kLatencies = 256;

  [[nodiscard]] std::string channel(const char* name) const { return prefix_ + "_" + name; }
  void send_pose(const PoseEstimate& estimate, Stamp now);
  void send_signed_pose(const MessageKey& key, Stamp now);
  void send_alert(alert_t& alert, Stamp now);
  void fill_latency(status_t& status);

  const std::string prefix_;
  const bool publish_detections_;
  const std::string pose_channel_;
  const std::string signed_pose_channel_;
  const std::string detections_channel_;
  const std::optional<MessageKey> key_;
  mutable PriorityMutex mutex_;
  SessionFacts session_;
  ClockOffset clock_;
  const Stamp started_;
  LcmPublisher publisher_;
  pose_t pose_;
  signed_pose_t signed_pose_{};
  detections_t detections_;
  PoseEstimate no_pose_;
  Stamp last_pose_;
  std::int64_t poses_ = 0;
  std::int64_t detection_messages_ = 0;
  std::int64_t alerts_ = 0;
  std::int64_t statuses_ = 0;
  std::array<std::int64_t, 4> by_status_{};
  std::array<std::int64_t, 4> summarized_{};  ///< of them, in the last summary
  std::string last_ok_;                       ///< pose_t.status_text
  std::string last_not_ok_;
  std::array<double, kLatencies> latency_ms_{};
  std::size_t latencies_ = 0;
};

}  // namespace waymark
