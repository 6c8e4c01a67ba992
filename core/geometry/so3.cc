#include "core/geometry/so3.h"

#include <cmath>

namespace waymark {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation_vector_rad) {
  const double angle = rotation_vector_rad.norm();
  // sin(angle/2)/angle, by its series where the quotient loses digits.
  const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(0.5 * angle);
  q.vec() = scale * rotation_vector_rad;
  return q;
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  const double cosine = std::abs(q.w());
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  // angle / sin(angle/2), by its series where the quotient loses digits.
  const double scale =
      sine < 1e-6 ? 2.0 + sine * sine / 3.0 : 2.0 * std::atan2(sine, cosine) / sine;
  return sign * scale * q.vec();
}

double angle_between_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return so3_log(a.conjugate() * b).norm();
}

}  // namespace waymark
