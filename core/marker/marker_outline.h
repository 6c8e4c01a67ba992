#pragma once

#include <array>

#include "core/marker/marker_geometry.h"

namespace waymark {

// A marker's outline in the image (px, image axes): corners in either sense of rotation, no two
// alike.

/// Mean of the corners.
[[nodiscard]] Eigen::Vector2d centre_of(const ImageCorners& corners);

/// Mean length of the sides.
[[nodiscard]] double mean_side_px(const ImageCorners& corners);

/// How each corner moves when all four sides move outward by one pixel: what blooming, print and
/// sensor response do.
[[nodiscard]] std::array<Eigen::Vector2d, 4> outward_of(const ImageCorners& corners);

/// Moves all four sides in by `px`.
void move_sides_in(double px, ImageCorners& corners);

/// How far the middles of `given`'s sides lie inside `black`, mean of the sides.
[[nodiscard]] double inset_px(const ImageCorners& given, const ImageCorners& black);

}  // namespace waymark
