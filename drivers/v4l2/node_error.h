#pragma once

#include "core/base/error.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// The error of a failed ioctl: `what` could not be done on `node`. Gone devices and busy ones
/// (naming who holds it) are unavailable; too little USB bandwidth says what helps; else io.
[[nodiscard]] Error node_error(const VideoNode& node, std::string_view what, int error_number);

/// Whether the device says by an error that it has no such thing: control, list or setting. Every
/// other error tells that it could not be asked.
[[nodiscard]] bool says_absent(int error_number);

}  // namespace waymark
