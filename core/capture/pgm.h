#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/capture/gray_image.h"

namespace waymark {

/// Whether the bytes begin as a PGM or another netpbm file does ("P1" … "P7").
[[nodiscard]] bool looks_like_pgm(std::string_view bytes);

/// Decodes binary PGM (P5) of 8 or 16 bits, scaled so that its maximum becomes 255. bad_data,
/// without the file's name, for anything else and for missing pixels.
[[nodiscard]] Expected<LoadedImage> decode_pgm(std::string_view bytes);

[[nodiscard]] std::string encode_pgm(const GrayView& image);

}  // namespace waymark
