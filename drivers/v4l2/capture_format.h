#pragma once

#include <string>
#include <vector>

#include "drivers/camera_options.h"
#include "drivers/frame_maker.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// What it was found to deliver.
struct CaptureFormat {
  FrameLayout layout;
  double fps = 0;  ///< 1/s, read back; 0: the device does not say
  bool multiplanar = false;
  std::size_t planes = 1;  ///< of a buffer; the first holds all we need

  /// The type of the device's buffers.
  [[nodiscard]] v4l2_buf_type buffer_type() const {
    return multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  }
};

/// Sets format and frame rate and reads both back. Errors: config, with what the device can do,
/// when it does not take them as they are or crops its image; those of node_error.
[[nodiscard]] Expected<CaptureFormat> set_capture_format(VideoNode& node,
                                                         const CaptureRequest& request);

/// "GREY 1224×1024, 640×480; YUYV …": everything that the device offers.
[[nodiscard]] std::string offered_formats(VideoNode& node);

/// A frame that the device offers, in a format that grey images can be made of.
struct OfferedFormat {
  const PixelFormat* pixels = nullptr;
  int width_px = 0;
  int height_px = 0;
};
/// By pixel formats, the best first, then as the device lists them. Without a list of sizes, 0×0.
[[nodiscard]] std::vector<OfferedFormat> understood_formats(VideoNode& node);

}  // namespace waymark
