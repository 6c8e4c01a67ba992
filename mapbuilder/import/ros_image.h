#pragma once

#include <string>

#include "core/base/error.h"
#include "core/capture/image_size.h"
#include "mapbuilder/import/ros_messages.h"

namespace waymark {

/// Whether a raw image's encoding is one that is read: mono8, mono16, rgb, bgr, rgba and bgra of 8
/// or 16 bits, the four bayer patterns of 8 or 16 bits, YUV 4:2:2, and OpenCV's names of such.
[[nodiscard]] bool is_known_encoding(std::string_view encoding);

/// A raw image as a PGM file, of 16 bits where it has 16: grey as it is, colour by Rec. 601 luma
/// as of PNG, bayer patterns by the luma of what bilinear interpolation makes of them, YUV by its
/// Y. bad_data, without a name, for encodings that are not read, for more than 200 megapixels, and
/// where rows and pixels do not fill what was stated.
[[nodiscard]] Expected<std::string> pgm_of_ros_image(const RosImage& image);

/// What a compressed image is: the ending of its file, "jpg" or "png", and the size in its header.
/// bad_data, without a name, for other formats, damaged headers and more than 200 megapixels.
struct CompressedKind {
  const char* ending;
  ImageSize size;
};
[[nodiscard]] Expected<CompressedKind> kind_of_compressed(const RosCompressedImage& image);

}  // namespace waymark
