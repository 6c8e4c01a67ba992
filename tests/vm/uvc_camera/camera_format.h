#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace waymark::uvc {

using Bytes = std::vector<std::uint8_t>;

/// How the camera sends its images.
enum class PixelFormat : std::uint8_t {
  grey,   ///< Y800, a byte per pixel: every frame has one size
  mjpeg,  ///< a JPEG file per frame
};

/// What the camera says of itself before a frame is asked for.
struct CameraFormat {
  std::uint16_t width_px = 0;
  std::uint16_t height_px = 0;
  double fps = 1;  ///< 1/s
  PixelFormat pixels = PixelFormat::grey;
  std::uint32_t max_frame_bytes = 0;
  std::string serial;

  [[nodiscard]] std::chrono::nanoseconds period() const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / fps));
  }
  /// 100 ns, the unit of every interval in the UVC standard.
  [[nodiscard]] std::uint32_t uvc_interval() const {
    return static_cast<std::uint32_t>(period().count() / 100);
  }
};

/// Appends little-endian numbers, as USB writes them.
inline void put16(Bytes& bytes, std::uint32_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
}
inline void put32(Bytes& bytes, std::uint32_t value) {
  put16(bytes, value & 0xFFFFU);
  put16(bytes, value >> 16U);
}
inline void put(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace waymark::uvc
