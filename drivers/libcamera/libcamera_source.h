#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "drivers/camera_options.h"
#include "drivers/frame_source.h"
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
/// for. Errors: unavailable when the module is not installed.
[[nodiscard]] Expected<std::unique_ptr<FrameSource>> libcamera_source(
    std::shared_ptr<VideoSystem> system, const LibcameraOptions& options);

/// What the module gives.
using MakeLibcameraSource = void(std::shared_ptr<VideoSystem> system,
                                 const LibcameraOptions& options,
                                 std::unique_ptr<FrameSource>& result);
inline constexpr const char* kLibcameraModule = "libwaymark_libcamera.so";
inline constexpr const char* kMakeLibcameraSourceSymbol = "waymark_make_libcamera_source";

}  // namespace waymark

extern "C" waymark::MakeLibcameraSource waymark_make_libcamera_source;
