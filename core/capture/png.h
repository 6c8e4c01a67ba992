#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/capture/gray_image.h"
#include "core/capture/image_size.h"

namespace waymark {

[[nodiscard]] bool looks_like_png(std::string_view bytes);

/// The size that the header states, however damaged the rest is.
[[nodiscard]] Expected<ImageSize> png_size(std::string_view bytes);

/// Decodes a PNG of any kind by spng, row by row: alpha dropped, colour by Rec. 601 luma of the
/// stored values (gamma chunks are ignored), of 16 bits the upper 8 of those in use
/// (bits_in_use; such images are decoded twice). bad_data, without
/// the file's name, for damaged or truncated ones, any other size than the expected one, and more
/// than 200 megapixels.
[[nodiscard]] Expected<LoadedImage> decode_png(std::string_view bytes,
                                               std::optional<ImageSize> expected = std::nullopt);

/// Grey PNG of 8 bits, compressed for speed.
[[nodiscard]] Expected<std::string> encode_png(const GrayView& image);

}  // namespace waymark
