#pragma once

#include <memory>
#include <string>

#include "drivers/frame_source.h"
#include "drivers/v4l2/camera_controls.h"
#include "drivers/v4l2/capture_format.h"
#include "drivers/v4l2/device_lookup.h"

namespace waymark {

/// One camera behind Video4Linux.
struct V4l2Options {
  std::string name;  ///< in the rig
  DeviceIdentity device;
  std::string serial;  ///< that rig.yaml states; empty: any
  CaptureRequest request;
  CameraControls controls;
  Stamp readout{0};  ///< rolling shutter, first to last row
};

/// A camera's frames by memory-mapped streaming: luma is used where the driver put it, other
/// formats are converted once. Every start finds the device anew, by its identity, and sets
/// everything anew. A device without a frame for five periods and two seconds is an io error.
[[nodiscard]] std::unique_ptr<FrameSource> v4l2_source(std::shared_ptr<VideoSystem> system,
                                                       const V4l2Options& options);

}  // namespace waymark
