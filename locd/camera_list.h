#pragma once

#include <iosfwd>

#include "drivers/v4l2/video_node.h"

namespace waymark {

/// `locd --list-cameras`: a [[camera]] block per camera, ready for locd.toml. unavailable when
/// there is none.
[[nodiscard]] Status list_cameras(VideoSystem& system, std::ostream& out);

}  // namespace waymark
