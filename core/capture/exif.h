#pragma once

#include <cstdint>
#include <span>

namespace waymark {

/// The orientation (tag 0x0112) of an EXIF block that starts at its TIFF header: 1 = as stored,
/// 2…8 = mirrored or rotated. 1 also when the block is damaged or says nothing.
[[nodiscard]] int exif_orientation(std::span<const std::uint8_t> tiff);

}  // namespace waymark
