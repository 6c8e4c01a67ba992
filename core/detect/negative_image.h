#pragma once

#include "core/capture/gray_image.h"

namespace waymark {

/// Images with black for white and white for black. Keeps its memory from image to image.
class NegativeImage {
 public:
  /// Valid until the next call.
  [[nodiscard]] GrayView of(const GrayView& image);

 private:
  GrayImage result_;
};

}  // namespace waymark
