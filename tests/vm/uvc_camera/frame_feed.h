#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "tests/vm/uvc_camera/camera_format.h"

namespace waymark::uvc {

/// What a camera sees: the images of one camera of a capture, one after the other, over and over,
/// with a sensor's noise: no two frames are equal, for a sensor whose frames are is broken.
struct FrameFeed {
  CameraFormat format;
  std::vector<Bytes> images;  ///< grey levels, row by row, without noise

  /// The frame of the instant `index` periods after the clock's zero, as it is sent. Cameras with
  /// equally many images and one clock show images of one instant at one time.
  [[nodiscard]] Bytes frame(std::int64_t index) const;
  /// The same of nothing but about this grey level.
  [[nodiscard]] Bytes painted_frame(std::uint8_t grey, std::int64_t index) const;
};

/// The noise: bit k of the frame's index changes this bit of every pixel of the k-th run of
/// kNoiseRun_px pixels of the image's first 8 rows. So a JPEG keeps it: it fills whole blocks.
inline constexpr std::uint8_t kNoiseBit = 0x02;
inline constexpr std::size_t kNoiseRun_px = 8;
inline constexpr std::size_t kNoiseRows = 8;

/// Reads CAPTURE/CAMERA's images by rising name. Errors: those of reading; bad_data when sizes
/// differ or when there is none.
[[nodiscard]] Expected<FrameFeed> read_frame_feed(const std::filesystem::path& folder,
                                                  PixelFormat pixels);

}  // namespace waymark::uvc
