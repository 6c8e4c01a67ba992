#pragma once

#include <libcamera/camera.h>
#include <libcamera/controls.h>

#include "core/base/error.h"
#include "drivers/camera_options.h"
#include "drivers/frame_maker.h"
#include "drivers/mid_exposure.h"
#include "drivers/v4l2/capture_format.h"

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

/// What grey images can be made of, the best format first.
[[nodiscard]] std::vector<OfferedFormat> understood_formats(libcamera::Camera& camera);

/// Controls to start a camera with, of those `offered`. Automatic focus is always off. Errors:
/// config for a value that the camera has no control for, or outside its range.
[[nodiscard]] Expected<libcamera::ControlList> start_controls(
    const libcamera::ControlInfoMap& offered, const CameraOptions& options);

/// What a frame's stamp means, by its metadata: libcamera's own time of it is that of its first
/// row; without one it is only known when the buffer was filled.
[[nodiscard]] StampMeaning stamp_meaning(const libcamera::ControlList& metadata);

/// A frame's exposure, by its metadata; `otherwise` where they don't tell.
[[nodiscard]] Stamp exposure_of(const libcamera::ControlList& metadata, Stamp otherwise);

/// Config when the metadata of `camera`'s frame tell of less than the whole image, which is not
/// what was calibrated. Cameras that don't tell of crops have none.
[[nodiscard]] Status check_crop(const std::string& camera, const libcamera::ControlList& metadata,
                                const libcamera::ControlList& properties);

}  // namespace waymark
