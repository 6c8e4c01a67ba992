// Publishes one message per channel, every field with a value of its own. Usage: publish_samples
// URL
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <numeric>
#include <waymark/alert_t.hpp>
#include <waymark/detections_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/signed_pose_t.hpp>
#include <waymark/status_t.hpp>

namespace {

waymark::pose_t pose() {
  waymark::pose_t m{};
  m.utime = 1'800'000'000'123'456;
  m.utime_published = 1'800'000'000'165'432;
  m.seq = 4'294'967'296;
  m.session_id = "0123456789abcdef";
  std::iota(std::begin(m.position), std::end(m.position), -1.5);
  std::iota(std::begin(m.quaternion), std::end(m.quaternion), 0.125);
  std::iota(std::begin(m.covariance), std::end(m.covariance), 0.25);
  m.status = waymark::pose_t::DEGRADED;
  m.status_text = "DEGRADED: sure to 12 mm and 0.31 deg only, a camera is in doubt";
  m.sigma_m = 0.012;
  m.sigma_deg = 0.31;
  m.resets = 7;
  m.protection_horizontal_m = 0.085;
  m.protection_deg = 1.25;
  m.protection_of_cameras = 1;
  std::iota(std::begin(m.protection_m), std::end(m.protection_m), 0.75);
  m.reasons = int{waymark::pose_t::SIGMA} + int{waymark::pose_t::CAMERA_SUSPECT};
  m.cameras = 3;
  m.cameras_used = 2;
  m.markers_used = 5;
  m.outliers = 1;
  m.rms_px = 0.375;
  m.max_skew_us = 120.5;
  m.camera_count = 3;
  m.camera_offset_us = {-60.25, std::nan(""), 60.25};
  m.map_hash = "fedcba9876543210";
  m.x_m = -1.5;
  m.y_m = -0.5;
  m.z_m = 0.5;
  m.yaw_deg = 179.5;
  m.latency_ms = 41.976;
  return m;
}

waymark::camera_status_t camera(const char* name, int number) {
  waymark::camera_status_t m{};
  m.name = name;
  m.state = static_cast<std::int8_t>(number);
  m.usable = static_cast<std::int8_t>(number == 1);
  m.rate_hz = 29.5 + number;
  m.frames = 1000 + number;
  m.dropped = 10 + number;
  m.starts = number;
  m.error = number == 1 ? "" : "no such device";
  return m;
}

waymark::status_t status() {
  waymark::status_t m{};
  m.utime = 1'800'000'001'000'000;
  m.seq = 17;
  m.session_id = "0123456789abcdef";
  m.version = "0.1.0";
  m.text = "29.5 frame sets/s; cam1 missing: no such device";
  m.uptime_s = 3600.25;
  m.map_hash = "fedcba9876543210";
  m.map_markers = 200;
  m.quarantined_markers = 2;
  m.camera_count = 2;
  m.cameras = {camera("cam0", 1), camera("cam1", 3)};
  m.set_rate_hz = 29.5;
  m.sets = 106'200;
  for (int i = 0; i < 4; ++i) m.poses[i] = 100 * i + 1;
  m.set_divisor = 2;
  m.drop_count = 2;
  m.drop_reason = {"late", "overload"};
  m.drops = {3, 4};
  m.latency_p50_ms = 41.5;
  m.latency_max_ms = 77.25;
  m.time_status = waymark::status_t::TIME_STEPPED;
  m.time_steps = 1;
  m.time_error_s = -3600.5;
  m.publish_failures = 9;
  m.recording = 1;
  m.recording_path = "/var/lib/locd/recordings/20270115T080000Z";
  m.recorded_sets = 55;
  m.recorder_drops = 6;
  m.recorded_bytes = 123'456'789'012;
  m.reload_refused = "hall.map: damaged";
  return m;
}

waymark::alert_t alert() {
  waymark::alert_t m{};
  m.utime = 1'800'000'002'000'000;
  m.seq = 3;
  m.session_id = "0123456789abcdef";
  m.raised = 1;
  m.kind = "MOVED";
  m.subject = "tag36h11:12";
  m.text = "MOVED: marker 12 hangs 0.310 m and 2.0 deg from where the map says";
  m.offset_m = 0.31;
  m.offset_rad = 0.035;
  m.map_hash = "fedcba9876543210";
  return m;
}

waymark::detections_t detections() {
  waymark::detections_t m{};
  m.utime = 1'800'000'000'123'456;
  m.seq = 8;
  m.session_id = "0123456789abcdef";
  m.rig = "00112233aabbccdd";
  m.camera_count = 3;
  m.camera_offset_us = {-12.5, 0, 12.5};
  m.count = 2;
  m.camera = {0, 2};
  m.family = {"tag36h11", "aruco_4x4_1000"};
  m.marker_id = {12, 999};
  m.corners_px = {{1.5F, 2.5F, 3.5F, 4.5F, 5.5F, 6.5F, 7.5F, 8.5F},
                  {100.25F, 1, 2, 3, 4, 5, 6, 1223.75F}};
  m.covariances_px2 = {{0.25F, 0, 0.25F, 0.25F, 0, 0.25F, 0.25F, 0, 0.25F, 0.25F, 0, 0.25F},
                       {1, 0.5F, 2, 1, 0.5F, 2, 1, 0.5F, 2, 1, 0.5F, 2}};
  m.verdict = {0, 3};
  return m;
}

waymark::signed_pose_t signed_pose() {
  waymark::signed_pose_t m{};
  m.seq = 4'294'967'296;
  m.pose = {1, 0, 127};
  m.size = 3;
  std::iota(std::begin(m.mac), std::end(m.mac), std::uint8_t{100});
  return m;
}

template <typename Message>
bool publish(lcm::LCM& lcm, const char* channel, const Message& message) {
  return lcm.publish(channel, &message) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  lcm::LCM lcm(argv[1]);
  if (!lcm.good()) return 69;
  const bool sent =
      publish(lcm, "WAYMARK_POSE", pose()) && publish(lcm, "WAYMARK_STATUS", status()) &&
      publish(lcm, "WAYMARK_ALERT", alert()) && publish(lcm, "WAYMARK_DETECTIONS", detections()) &&
      publish(lcm, "WAYMARK_SIGNED_POSE", signed_pose());
  if (!sent) std::fputs("publish_samples: LCM took not every message\n", stderr);
  return sent ? 0 : 74;
}
