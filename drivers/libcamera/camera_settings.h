#pragma once

#include <libcamera/camera.h>
#include <libcamera/controls.h>

#include "core/base/error.h"
#include "drivers/camera_options.h"
#include "drivers/frame_maker.h"

namespace waymark {

/// The configuration of a camera's one stream, as wanted. Errors: config, with what the camera
/// offers, when it would change anything about it.
struct StreamSettings {
  std::unique_ptr<libcamera::CameraConfiguration> configuration;
  FrameLayout layout;
};
[[nodiscard]] Expected<StreamSettings> stream_settings(libcamera::Camera& camera,
                                                       const CaptureRequest& request);

/// "GREY 1224×1024; YUYV …": what the camera offers.
[[nodiscard]] std::string offered_formats(libcamera::Camera& camera);

/// Controls to start a camera with, of those `offered`. Automatic focus is always off. Errors:
/// config for a value that the camera has no control for, or outside its range.
[[nodiscard]] Expected<libcamera::ControlList> start_controls(
    const libcamera::ControlInfoMap& offered, const CameraOptions& options);

}  // namespace waymark
