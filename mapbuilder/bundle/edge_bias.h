#pragma once

#include <array>

#include "core/marker/marker_geometry.h"

namespace waymark {

/// How each corner moves (px, image axes) when all four edges of a marker move outward by one
/// pixel: what blooming, print and sensor response do. Corners in either sense of rotation, no two
/// alike.
[[nodiscard]] std::array<Eigen::Vector2d, 4> outward_of(const ImageCorners& corners);

/// Moves all four edges in by `bias_px`.
void move_edges_in(double bias_px, ImageCorners& corners);

}  // namespace waymark
