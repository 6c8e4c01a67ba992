#include "core/marker/marker_geometry.h"

#include <cmath>

namespace waymark {

std::array<Eigen::Vector3d, 4> marker_corners(double size_m) {
  const double s = 0.5 * size_m;
  return {{{-s, s, 0}, {s, s, 0}, {s, -s, 0}, {-s, -s, 0}}};
}

double area_px2(const ImageCorners& corners) {
  const Eigen::Vector2d a = corners[2] - corners[0];
  const Eigen::Vector2d b = corners[3] - corners[1];
  return 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
}

}  // namespace waymark
