#include "core/geometry/square_homography.h"

#include <cmath>
#include <cstddef>

namespace waymark {
namespace {

/// Whether any three corners lie on a line: the sine of an angle of theirs is no more than what
/// rounding leaves of zero, at any scale.
bool three_lie_on_a_line(const std::array<Eigen::Vector2d, 4>& quad) {
  constexpr double kLeastSine = 1e-9;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d to_next = quad[(i + 1) % 4] - quad[i];
    const Eigen::Vector2d to_last = quad[(i + 3) % 4] - quad[i];
    const double cross = to_next.x() * to_last.y() - to_next.y() * to_last.x();
    if (!(std::abs(cross) > kLeastSine * to_next.norm() * to_last.norm())) return true;
  }
  return false;
}

}  // namespace

std::optional<Eigen::Matrix3d> homography_from_unit_square(
    const std::array<Eigen::Vector2d, 4>& quad) {
  if (three_lie_on_a_line(quad)) return std::nullopt;
  const auto& [a, b, c, d] = quad;
  const Eigen::Vector2d bc = b - c;
  const Eigen::Vector2d dc = d - c;
  const Eigen::Vector2d sum = a - b + c - d;
  const double determinant = bc.x() * dc.y() - bc.y() * dc.x();
  const double g = (sum.x() * dc.y() - sum.y() * dc.x()) / determinant;
  const double h = (bc.x() * sum.y() - bc.y() * sum.x()) / determinant;
  Eigen::Matrix3d quad_from_unit;
  quad_from_unit << b.x() - a.x() + g * b.x(), d.x() - a.x() + h * d.x(), a.x(),  //
      b.y() - a.y() + g * b.y(), d.y() - a.y() + h * d.y(), a.y(),                //
      g, h, 1.0;
  return quad_from_unit;
}

}  // namespace waymark
