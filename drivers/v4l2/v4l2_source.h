#pragma once

#include <memory>

#include "drivers/camera_options.h"
#include "drivers/frame_source.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// A camera's frames by memory-mapped streaming: luma is used where the driver put it, other
/// formats are converted once. Every start finds the device anew, by its identity, and sets
/// everything anew. A device without a frame for five periods and two seconds is an io error. The
/// options are valid (checked).
[[nodiscard]] std::unique_ptr<FrameSource> v4l2_source(std::shared_ptr<VideoSystem> system,
                                                       const CameraOptions& options);

}  // namespace waymark
