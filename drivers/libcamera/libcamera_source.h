#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "drivers/camera_options.h"
#include "drivers/frame_source.h"
#include "drivers/v4l2/capture_format.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// One camera behind libcamera.
struct LibcameraOptions {
  CameraOptions camera;  ///< its device is one of Video4Linux's, by which libcamera knows it
  std::string id;  ///< not empty: libcamera's own name of it instead, as `cam --list` prints it
};

/// Whether a device in locd.toml is meant as libcamera's own name; else it is a DeviceIdentity.
[[nodiscard]] bool is_libcamera_id(std::string_view device);

/// A camera's frames by libcamera's requests, which are recycled. Luma is used where the driver put
/// it. Loads the module that holds libcamera, which programs without such a camera need not pay
/// for. The options are valid (checked). Errors: unavailable when the module is not installed.
[[nodiscard]] Expected<std::unique_ptr<FrameSource>> libcamera_source(
    std::shared_ptr<VideoSystem> system, const LibcameraOptions& options);

/// A camera that libcamera has.
struct LibcameraCamera {
  std::string id;
  std::string model;
  std::string offered;                    ///< everything, for messages
  std::vector<OfferedFormat> understood;  ///< the best first
  std::vector<std::string> nodes;         ///< of Video4Linux that are this camera's
};
/// All of them; none where the module is not installed or libcamera can't start.
[[nodiscard]] std::vector<LibcameraCamera> libcamera_cameras(VideoSystem& system);

/// What the module gives.
using MakeLibcameraSource = void(std::shared_ptr<VideoSystem> system,
                                 const LibcameraOptions& options,
                                 std::unique_ptr<FrameSource>& result);
inline constexpr const char* kLibcameraModule = "libwaymark_libcamera.so";
inline constexpr const char* kMakeLibcameraSourceSymbol = "waymark_make_libcamera_source";
using ListLibcameraCameras = void(VideoSystem& system, std::vector<LibcameraCamera>& result);
inline constexpr const char* kListLibcameraCamerasSymbol = "waymark_list_libcamera_cameras";

}  // namespace waymark

extern "C" waymark::MakeLibcameraSource waymark_make_libcamera_source;
extern "C" waymark::ListLibcameraCameras waymark_list_libcamera_cameras;
