#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/capture/gray_image.h"

namespace waymark {

[[nodiscard]] bool looks_like_png(std::string_view bytes);

/// Decodes a PNG of any kind by libpng: the upper 8 bits of 16, alpha dropped, colour by Rec. 601
/// luma of the stored values (gamma chunks are ignored). bad_data, without the file's name, for
/// damaged or truncated ones and more than 200 megapixels.
[[nodiscard]] Expected<LoadedImage> decode_png(std::string_view bytes);

/// Grey PNG of 8 bits, compressed for speed.
[[nodiscard]] Expected<std::string> encode_png(const GrayView& image);

}  // namespace waymark
