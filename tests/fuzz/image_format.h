#pragma once

#include <optional>
#include <string>

#include "core/base/check.h"
#include "core/capture/gray_image.h"
#include "core/capture/image_size.h"
#include "tests/support/test_pattern.h"

namespace waymark::test {

inline constexpr ImageSize kImageSize{40, 30};  ///< of the seeds

[[nodiscard]] inline GrayImage image_seed() {
  return test_pattern(static_cast<int>(kImageSize.width_px),
                      static_cast<int>(kImageSize.height_px));
}

/// Decodes without an expected size where the header states a small one; larger ones are held
/// against that of the seeds, as programs do. What is decoded is of the size that was stated.
template <typename SizeOf, typename Decode>
[[nodiscard]] Expected<LoadedImage> read_image(const std::string& bytes, SizeOf size_of,
                                               Decode decode) {
  const Expected<ImageSize> size = size_of(bytes);
  const bool small = size && size->width_px < 256 && size->height_px < 256;
  auto loaded = decode(bytes, small ? std::nullopt : std::optional(kImageSize));
  if (loaded) {
    WAYMARK_CHECK(size && loaded->image.width_px == size->width_px &&
                  loaded->image.height_px == size->height_px);
  }
  return loaded;
}

}  // namespace waymark::test
