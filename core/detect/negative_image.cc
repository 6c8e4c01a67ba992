#include "core/detect/negative_image.h"

namespace waymark {

GrayView NegativeImage::of(const GrayView& image) {
  result_.width_px = image.width_px;
  result_.height_px = image.height_px;
  result_.pixels.resize(static_cast<std::size_t>(image.width_px) *
                        static_cast<std::size_t>(image.height_px));
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* pixels = image.row(y);
    std::uint8_t* const __restrict negative = result_.row(y);
    for (int x = 0; x < image.width_px; ++x) negative[x] = static_cast<std::uint8_t>(~pixels[x]);
  }
  return result_.view();
}

}  // namespace waymark
