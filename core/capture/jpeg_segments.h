#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace waymark {

/// What the segments of a JPEG tell before a pixel is decoded.
struct JpegSegments {
  int scans = 0;             ///< counted to one beyond the limit that was asked for
  bool progressive = false;  ///< pixels are complete after the last scan only
  int orientation = 1;       ///< as EXIF says; 1 is upright
  /// The same JPEG without what decoders complain of though it harms nothing: bytes between the
  /// segments, unknown versions of JFIF and Adobe. Empty where there is nothing of the kind.
  std::string tidied;
};

/// Walks from marker to marker, as decoders do, in time linear in the bytes. Ends quietly where the
/// bytes do, or make no sense: the decoder says so.
[[nodiscard]] JpegSegments walk_jpeg(std::string_view bytes, int scan_limit);

}  // namespace waymark
