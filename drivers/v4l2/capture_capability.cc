#include "drivers/v4l2/capture_capability.h"

#include <algorithm>

#include "drivers/v4l2/node_error.h"

namespace waymark {
namespace {

/// Text of a fixed-size field, which need not end with a zero.
template <std::size_t size>
std::string text_of(const __u8 (&field)[size]) {
  return {std::begin(field), std::find(std::begin(field), std::end(field), 0)};
}

}  // namespace

Expected<CaptureCapability> capture_capability(VideoNode& node) {
  v4l2_capability about{};
  if (const int failed = node.request(VIDIOC_QUERYCAP, &about); failed != 0) {
    return tl::make_unexpected(node_error(node, "can't be asked what it is", failed));
  }
  // A device of several nodes states what all of them can, besides what this one can.
  const bool of_node = (about.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const __u32 can = of_node ? about.device_caps : about.capabilities;
  CaptureCapability capability;
  capability.bus = text_of(about.bus_info);
  capability.card = text_of(about.card);
  capability.multiplanar = (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
  capability.captures = capability.multiplanar || (can & V4L2_CAP_VIDEO_CAPTURE) != 0;
  capability.can_stream = (can & V4L2_CAP_STREAMING) != 0;
  return capability;
}

}  // namespace waymark
