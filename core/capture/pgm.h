#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/capture/gray_image.h"
#include "core/capture/image_size.h"

namespace waymark {

/// Whether the bytes begin as a PGM or another netpbm file does ("P1" … "P7").
[[nodiscard]] bool looks_like_pgm(std::string_view bytes);

/// The size that the header states.
[[nodiscard]] Expected<ImageSize> pgm_size(std::string_view bytes);

/// Decodes binary PGM (P5) of 8 or 16 bits, scaled so that its maximum becomes 255; a maximum of
/// 65535 by the bits in use (bits_in_use). bad_data, without the file's name, for anything else,
/// any other size than the expected one, and for missing pixels.
[[nodiscard]] Expected<LoadedImage> decode_pgm(std::string_view bytes,
                                               std::optional<ImageSize> expected = std::nullopt);

[[nodiscard]] std::string encode_pgm(const GrayView& image);

}  // namespace waymark
