#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/capture/gray_image.h"
#include "core/capture/image_size.h"

namespace waymark {

[[nodiscard]] bool looks_like_jpeg(std::string_view bytes);

/// The size that the header states, however damaged the rest is.
[[nodiscard]] Expected<ImageSize> jpeg_size(std::string_view bytes);

/// Decodes the luma of a JPEG by libjpeg-turbo. bad_data, without the file's name, for damaged or
/// truncated ones, CMYK, any other size than the expected one, more than 200 megapixels, and more
/// than 20 scans (each takes as long as an image, however few its bytes; programs write 10).
/// Extraneous bytes between segments, which some cameras write, are allowed.
[[nodiscard]] Expected<LoadedImage> decode_jpeg(std::string_view bytes,
                                                std::optional<ImageSize> expected = std::nullopt);

/// The same of a camera's frame, into memory that is there: bad_data also when it has several scans
/// (is progressive), which no camera's has. After an error the pixels are whatever.
[[nodiscard]] Status decode_jpeg_into(std::string_view bytes, GrayImage& image);

/// Grey JPEG; quality 1…100 (checked), sides 1…65500 px (bad_data beyond).
[[nodiscard]] Expected<std::string> encode_jpeg(const GrayView& image, int quality);

}  // namespace waymark
