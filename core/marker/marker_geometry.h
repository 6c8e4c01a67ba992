#pragma once

#include <Eigen/Core>
#include <array>

namespace waymark {

/// Corner order everywhere: as seen from the front, upright as the family draws the marker.
enum class Corner { top_left = 0, top_right = 1, bottom_right = 2, bottom_left = 3 };

/// Pixels of the four corners, in the order of `Corner`.
using ImageCorners = std::array<Eigen::Vector2d, 4>;

/// Corner positions (m) in the marker frame: x right, y up, z out of the marker towards the viewer;
/// `size_m` is the outer edge of the black border. Paper §III-C's P_m with s = size_m / 2.
[[nodiscard]] std::array<Eigen::Vector3d, 4> marker_corners(double size_m);

/// Area (px²) of the corners' quadrangle.
[[nodiscard]] double area_px2(const ImageCorners& corners);

}  // namespace waymark
