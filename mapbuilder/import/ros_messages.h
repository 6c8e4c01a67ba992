#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/stamp.h"

namespace waymark {

inline constexpr std::string_view kRosImage = "sensor_msgs/msg/Image";
inline constexpr std::string_view kRosCompressedImage = "sensor_msgs/msg/CompressedImage";
inline constexpr std::string_view kRosCameraInfo = "sensor_msgs/msg/CameraInfo";

/// sensor_msgs/msg/Image. Pixels lie in the message, which must outlive it.
struct RosImage {
  Stamp stamp{0};  ///< header.stamp
  std::uint32_t height_px = 0;
  std::uint32_t width_px = 0;
  std::string encoding;
  bool big_endian = false;
  std::uint32_t step_bytes = 0;  ///< from row to row
  std::span<const std::uint8_t> data;
};

/// sensor_msgs/msg/CompressedImage, likewise.
struct RosCompressedImage {
  Stamp stamp{0};
  std::string format;
  std::span<const std::uint8_t> data;  ///< a JPEG's or PNG's file
};

/// sensor_msgs/msg/CameraInfo: what a driver knows of its lens.
struct RosCameraInfo {
  std::uint32_t height_px = 0;
  std::uint32_t width_px = 0;
  std::string distortion_model;
  std::vector<double> distortion;
  std::array<double, 9> camera_matrix{};  ///< of the images as taken
  std::array<double, 9> rectification{};
  std::array<double, 12> projection_matrix{};  ///< of rectified images
  bool binned = false;                         ///< or cropped: the numbers are not the images'
};

/// Takes serialized messages apart. bad_data, without a name, for another encoding than CDR, for
/// messages that end too early, and for stamps that are none.
[[nodiscard]] Expected<RosImage> parse_ros_image(std::span<const std::uint8_t> message);
[[nodiscard]] Expected<RosCompressedImage> parse_ros_compressed_image(
    std::span<const std::uint8_t> message);
[[nodiscard]] Expected<RosCameraInfo> parse_ros_camera_info(std::span<const std::uint8_t> message);

}  // namespace waymark
