#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/capture/gray_image.h"
#include "core/detect/image_side.h"

namespace waymark {

/// Where a side of a marker really lies, to a fraction of a pixel, and the greys on both sides of
/// it.
struct FoundSide {
  Eigen::Vector2d shift_px;  ///< outward, at the side's start and end
  double bow_px = 0;         ///< farther outward in its middle
  double black_grey = 0;
  double white_grey = 0;
  double blur_px = 1;  ///< rough standard deviation of the step
};

/// Looks up to `reach_px` inside and outside of `side` for the step from dark to light that most of
/// its profiles agree on. nullopt when there is none or half of the profiles miss it.
[[nodiscard]] std::optional<FoundSide> search_side(const GrayView& image, const ImageSide& side,
                                                   double reach_px);

}  // namespace waymark
