#include "core/geometry/square_homography.h"

#include <cmath>

namespace waymark {

std::optional<Eigen::Matrix3d> homography_from_unit_square(
    const std::array<Eigen::Vector2d, 4>& quad) {
  const auto& [a, b, c, d] = quad;
  const Eigen::Vector2d bc = b - c;
  const Eigen::Vector2d dc = d - c;
  const Eigen::Vector2d sum = a - b + c - d;
  const double determinant = bc.x() * dc.y() - bc.y() * dc.x();
  if (!(std::abs(determinant) >= 1e-16)) return std::nullopt;
  const double g = (sum.x() * dc.y() - sum.y() * dc.x()) / determinant;
  const double h = (bc.x() * sum.y() - bc.y() * sum.x()) / determinant;
  Eigen::Matrix3d quad_from_unit;
  quad_from_unit << b.x() - a.x() + g * b.x(), d.x() - a.x() + h * d.x(), a.x(),  //
      b.y() - a.y() + g * b.y(), d.y() - a.y() + h * d.y(), a.y(),                //
      g, h, 1.0;
  return quad_from_unit;
}

}  // namespace waymark
