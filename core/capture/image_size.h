#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/error.h"

namespace waymark {

/// Width and height of an image, as a header or a rig states them.
struct ImageSize {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;

  [[nodiscard]] bool operator==(const ImageSize&) const = default;
};

/// Larger images than any camera takes are refused before memory is asked for.
inline constexpr std::int64_t kMaxImagePixels = 200'000'000;

/// What a header says is held against what is expected, before a pixel is decoded: bad_data for
/// more than 200 megapixels, and for any other size than the expected one.
[[nodiscard]] Status check_image_size(ImageSize found, std::optional<ImageSize> expected);

}  // namespace waymark
