#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include <waymark/detections_t.hpp>

namespace waymark::test {

/// A number as lcm-logger writes it, the highest byte first.
inline std::string big_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i));
  return text;
}

/// One event of lcm-logger's.
inline std::string lcm_event(std::string_view channel, std::string_view data) {
  return big_endian(0xEDA1DA01, 4) + big_endian(7, 8) + big_endian(1'700'000'000'000'000, 8) +
         big_endian(channel.size(), 4) + big_endian(data.size(), 4) + std::string(channel) +
         std::string(data);
}

/// As LCM encodes it.
inline std::string encoded(const detections_t& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// Two cameras of three gave a frame, the first saw a marker; every set 0.1 s after the last.
inline detections_t detections_message(int set) {
  detections_t m{};
  m.utime = 1'700'000'000'000'000 + 100'000 * set;
  m.seq = set;
  m.session_id = "0123456789abcdef";
  m.rig = "00112233aabbccdd";
  m.camera_count = 3;
  m.camera_offset_us = {-1.5, std::numeric_limits<double>::quiet_NaN(), 1.5};
  m.count = 1;
  m.camera = {0};
  m.family = {"tag36h11"};
  m.marker_id = {12};
  m.corners_px = {{10.5F, 20.25F, 30, 20, 30, 40, 10, 40}};
  m.covariances_px2 = {{0.25F, 0.125F, 0.5F, 1, 0, 1, 1, 0, 1, 1, 0, 1}};
  m.verdict = {0};
  return m;
}

}  // namespace waymark::test
