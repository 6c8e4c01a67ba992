#pragma once

#include <vector>

#include "core/capture/detection.h"
#include "core/capture/gray_image.h"

namespace waymark {

/// The dark squares of an image, each once, whether or not they can be read as markers: what the
/// detector itself looks at before it decodes. Corners are rough and run clockwise, any of them
/// first. Sides below `min_side_px` are passed over.
[[nodiscard]] std::vector<ImageCorners> find_squares(const GrayView& image,
                                                     double min_side_px = 12);

/// What the white cells of codes may fill, whatever stands around them: rectangles of what is
/// bright, its gaps closed. Corners run clockwise, any of them first.
[[nodiscard]] std::vector<ImageCorners> find_code_areas(const GrayView& image,
                                                        double min_side_px = 8);

}  // namespace waymark
