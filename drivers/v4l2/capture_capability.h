#pragma once

#include <string>

#include "drivers/v4l2/video_node.h"

namespace waymark {

/// What a video node says it is.
struct CaptureCapability {
  std::string bus;
  std::string card;
  bool captures = false;     ///< video, in buffers of one plane or several
  bool multiplanar = false;  ///< in buffers of several planes
  bool can_stream = false;

  /// Whether it is a camera that we can use.
  [[nodiscard]] bool streams() const { return captures && can_stream; }
};

/// Errors: those of node_error.
[[nodiscard]] Expected<CaptureCapability> capture_capability(VideoNode& node);

}  // namespace waymark
