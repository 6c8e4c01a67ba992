#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/capture/gray_image.h"

namespace waymark {

[[nodiscard]] bool looks_like_jpeg(std::string_view bytes);

/// Decodes the luma of a JPEG by libjpeg-turbo. bad_data, without the file's name, for damaged or
/// truncated ones, CMYK, and more than 200 megapixels. Extraneous bytes between segments, which
/// some cameras write, are allowed.
[[nodiscard]] Expected<LoadedImage> decode_jpeg(std::string_view bytes);

/// The same of a camera's frame, into memory that is there: bad_data also when the JPEG's size is
/// not the image's, or when it has several scans (is progressive), which no camera's has: each
/// takes as long as an image, however few its bytes. After an error the pixels are whatever.
[[nodiscard]] Status decode_jpeg_into(std::string_view bytes, GrayImage& image);

/// Grey JPEG; quality 1…100 (checked), sides 1…65500 px (bad_data beyond).
[[nodiscard]] Expected<std::string> encode_jpeg(const GrayView& image, int quality);

}  // namespace waymark
