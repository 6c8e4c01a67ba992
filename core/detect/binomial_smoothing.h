#pragma once

#include <cstdint>
#include <vector>

#include "core/capture/gray_image.h"

namespace waymark {

/// Takes noise out of images: every pixel becomes the mean of the 3×3 around it, weighted
/// (1 2 1)ᵀ(1 2 1) / 16; white noise falls to 0.375 of its sigma, edges widen by 0.7 px in sigma.
/// The image's own outermost pixels stand for what is outside. Keeps its memory.
class BinomialSmoothing {
 public:
  /// Valid until the next call. The image has at least one pixel.
  [[nodiscard]] GrayView smoothed(const GrayView& image);

 private:
  GrayImage result_;
  std::vector<std::uint16_t> rows_[3];  ///< weighted along the row, not yet across
};

}  // namespace waymark
