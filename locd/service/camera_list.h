#pragma once

#include <iosfwd>

#include "drivers/libcamera/libcamera_source.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// `locd --list-cameras`: a [[camera]] block per camera, ready for locd.toml, or why there is none;
/// by libcamera where V4L2 has none. unavailable when there is no camera.
[[nodiscard]] Status list_cameras(VideoSystem& system,
                                  const std::vector<LibcameraCamera>& by_libcamera,
                                  std::ostream& out);

}  // namespace waymark
