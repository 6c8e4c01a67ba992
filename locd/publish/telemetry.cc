#include "locd/publish/telemetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "locd/publish/status_text.h"

namespace waymark {
namespace {

/// Of a pose of sixteen cameras, with room to spare.
constexpr std::size_t kMaxPoseBytes = 4096;

}  // namespace

Telemetry::Telemetry(const LcmOptions& lcm, SessionFacts session, const ClockReading& now,
                     std::optional<MessageKey> key)
    : prefix_(lcm.channel_prefix),
      publish_detections_(lcm.detections),
      pose_channel_(channel("POSE")),
      signed_pose_channel_(channel("SIGNED_POSE")),
      detections_channel_(channel("DETECTIONS")),
      key_(key),
      session_(std::move(session)),
      clock_(now),
      started_(now.monotonic),
      publisher_(lcm.url, now.monotonic),
      pose_(make_pose_message(session_)),
      detections_(make_detections_message(session_)),
      last_pose_(now.monotonic) {
  WAYMARK_CHECK(is_channel_prefix(lcm.channel_prefix));
  signed_pose_.pose.reserve(kMaxPoseBytes);
  last_ok_.reserve(kMostStatusText);
  last_not_ok_.reserve(kMostStatusText);
}

Stamp Telemetry::publish_pose(const PoseEstimate& estimate, Stamp now) {
  const std::lock_guard lock(mutex_);
  send_pose(estimate, now);
  latency_ms_[latencies_++ % kLatencies] = pose_.latency_ms;
  if (!publish_detections_) return clock_.offset();
  fill_detections(estimate, session_, clock_, detections_);
  detections_.seq = detection_messages_++;
  publisher_.publish(detections_channel_, detections_, now);
  return clock_.offset();
}

void Telemetry::keep_alive(Stamp now, PoseReason why) {
  const std::lock_guard lock(mutex_);
  if (now - last_pose_ < kHeartbeat) return;
  no_pose_.reset(why);
  no_pose_.stamp = now;
  send_pose(no_pose_, now);
}

Stamp Telemetry::next_keep_alive() const {
  const std::lock_guard lock(mutex_);
  return last_pose_ + kHeartbeat;
}

void Telemetry::send_pose(const PoseEstimate& estimate, Stamp now) {
  fill_pose(estimate, session_, clock_, now, pose_);
  pose_.seq = poses_++;
  ++by_status_[static_cast<std::size_t>(estimate.status)];
  (estimate.status == PoseStatus::ok ? last_ok_ : last_not_ok_) = pose_.status_text;
  last_pose_ = now;
  publisher_.publish(pose_channel_, pose_, now);
  if (key_) send_signed_pose(*key_, now);
}

void Telemetry::send_signed_pose(const MessageKey& key, Stamp now) {
  signed_pose_.seq = pose_.seq;
  signed_pose_.size = pose_.getEncodedSize();
  signed_pose_.pose.resize(static_cast<std::size_t>(signed_pose_.size));
  WAYMARK_CHECK(pose_.encode(signed_pose_.pose.data(), 0, signed_pose_.size) == signed_pose_.size);
  key.sign(signed_pose_channel_, signed_pose_);
  publisher_.publish(signed_pose_channel_, signed_pose_, now);
}

void Telemetry::publish_alert(const Alert& alert, const Rig& rig, const MapIdentity& map,
                              Stamp now) {
  const std::lock_guard lock(mutex_);
  alert_t message{};
  fill_alert(alert, rig, map, session_, clock_, message);
  send_alert(message, now);
}

void Telemetry::publish_alert(const std::string& kind, const std::string& subject,
                              const std::string& text, bool raised, Stamp now) {
  const std::lock_guard lock(mutex_);
  alert_t message{};
  message.utime = clock_.utime_us(now);
  message.session_id = session_.session_id;
  message.raised = static_cast<std::int8_t>(raised);
  message.kind = kind;
  message.subject = subject;
  message.text = text;
  message.offset_m = std::numeric_limits<double>::quiet_NaN();
  message.offset_rad = std::numeric_limits<double>::quiet_NaN();
  message.map_hash = session_.map_hash;
  send_alert(message, now);
}

void Telemetry::send_alert(alert_t& alert, Stamp now) {
  alert.seq = alerts_++;
  publisher_.publish(channel("ALERT"), alert, now);
}

std::string Telemetry::take_pose_summary(Stamp interval) {
  const std::lock_guard lock(mutex_);
  std::int64_t poses = 0;
  std::array<std::int64_t, 4> fresh{};
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    fresh[i] = by_status_[i] - std::exchange(summarized_[i], by_status_[i]);
    poses += fresh[i];
  }
  if (poses == 0) return "no poses";
  const std::int64_t ok = fresh[static_cast<std::size_t>(PoseStatus::ok)];
  const double rate = static_cast<double>(poses) / std::max(in_s(interval), 1e-3);
  std::string text =
      fmt::format("OK {:.0f} % of {:.0f}/s",
                  100.0 * static_cast<double>(ok) / static_cast<double>(poses), rate);
  constexpr std::size_t kOk = 2;  // "OK, 14 markers, 3 mm" without its OK
  if (ok > 0) text += last_ok_.substr(kOk);
  if (ok < poses) text += "; " + last_not_ok_;
  return text;
}

void Telemetry::publish_status(status_t& status, Stamp now) {
  const std::lock_guard lock(mutex_);
  status.utime = clock_.utime_us(now);
  status.seq = statuses_++;
  status.session_id = session_.session_id;
  status.uptime_s = in_s(now - started_);
  status.map_hash = session_.map_hash;
  std::copy(by_status_.begin(), by_status_.end(), std::begin(status.poses));
  fill_latency(status);
  status.time_status = static_cast<std::int8_t>(clock_.status());
  status.time_steps = clock_.steps();
  status.time_error_s = in_s(clock_.error());
  status.publish_failures = publisher_.failures();
  publisher_.publish(channel("STATUS"), status, now);
}

void Telemetry::fill_latency(status_t& status) {
  status.latency_p50_ms = status.latency_max_ms = std::numeric_limits<double>::quiet_NaN();
  const auto end =
      latency_ms_.begin() + static_cast<std::ptrdiff_t>(std::min(latencies_, kLatencies));
  latencies_ = 0;
  if (end == latency_ms_.begin()) return;
  const auto middle = latency_ms_.begin() + (end - latency_ms_.begin()) / 2;
  std::nth_element(latency_ms_.begin(), middle, end);
  status.latency_p50_ms = *middle;
  status.latency_max_ms = *std::max_element(middle, end);
}

void Telemetry::set_map(const MapIdentity& map) {
  const std::lock_guard lock(mutex_);
  session_.map_hash = map.map_hash;
  session_.world_z_is_up = map.world_z_is_up;
}

ClockEvent Telemetry::follow_clocks(const ClockReading& now) {
  const std::lock_guard lock(mutex_);
  return clock_.update(now);
}

SessionFacts Telemetry::session() const {
  const std::lock_guard lock(mutex_);
  return session_;
}

std::int64_t Telemetry::utime_us(Stamp stamp) const {
  const std::lock_guard lock(mutex_);
  return clock_.utime_us(stamp);
}

Stamp Telemetry::utime_offset() const {
  const std::lock_guard lock(mutex_);
  return clock_.offset();
}

bool Telemetry::date_known() const {
  const std::lock_guard lock(mutex_);
  return clock_.date_known();
}

}  // namespace waymark
