#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "tests/vm/uvc_camera/camera_format.h"

namespace waymark::uvc {

/// What a camera sees: the images of one camera of a capture, one after the other, over and over.
struct FrameFeed {
  CameraFormat format;
  std::vector<Bytes> frames;

  /// The image of the instant `index` periods after the clock's zero. Cameras with equally many
  /// images and one clock show images of one instant at one time.
  [[nodiscard]] const Bytes& at(std::int64_t index) const {
    return frames[static_cast<std::size_t>(index) % frames.size()];
  }
};

/// Reads CAPTURE/CAMERA's images by rising name; MJPEG sends JPEG files as they are. Errors:
/// those of reading; bad_data when sizes differ, when there is none, or when one is no JPEG.
[[nodiscard]] Expected<FrameFeed> read_frame_feed(const std::filesystem::path& folder,
                                                  PixelFormat pixels);

}  // namespace waymark::uvc
