#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace waymark {

/// A straight line in a plane: a point of it, and its direction, of any length but zero.
struct Line2 {
  Eigen::Vector2d point;
  Eigen::Vector2d direction;
};

/// Where two lines meet; nullopt where the sine of the angle between them is below `least_sine`.
[[nodiscard]] inline std::optional<Eigen::Vector2d> intersection(const Line2& a, const Line2& b,
                                                                 double least_sine) {
  const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
    return u.x() * v.y() - u.y() * v.x();
  };
  const double determinant = cross(a.direction, b.direction);
  if (!(std::abs(determinant) > least_sine * a.direction.norm() * b.direction.norm())) {
    return std::nullopt;
  }
  return Eigen::Vector2d(a.point +
                         cross(b.point - a.point, b.direction) / determinant * a.direction);
}

}  // namespace waymark
