#include "core/geometry/rigid3.h"

namespace waymark {

Rigid3 Rigid3::inverse() const {
  const Eigen::Quaterniond r = rotation.conjugate();
  return {r, -(r * translation)};
}

Rigid3 Rigid3::plus(const Vector6d& delta) const {
  return {(so3_exp(delta.tail<3>()) * rotation).normalized(), translation + delta.head<3>()};
}

Vector6d Rigid3::minus(const Rigid3& from) const {
  Vector6d delta;
  delta << translation - from.translation, so3_log(rotation * from.rotation.conjugate());
  return delta;
}

Rigid3 operator*(const Rigid3& a_from_b, const Rigid3& b_from_c) {
  return {(a_from_b.rotation * b_from_c.rotation).normalized(),
          a_from_b.rotation * b_from_c.translation + a_from_b.translation};
}

Eigen::Vector3d operator*(const Rigid3& a_from_b, const Eigen::Vector3d& x_in_b) {
  return a_from_b.rotation * x_in_b + a_from_b.translation;
}

Matrix6d left_motion_jacobian(const Rigid3& b_from_a) {
  const Eigen::Matrix3d r = b_from_a.rotation.toRotationMatrix();
  Matrix6d j = Matrix6d::Zero();
  j.topLeftCorner<3, 3>() = r;
  j.bottomRightCorner<3, 3>() = r;
  return j;
}

Matrix6d inverse_covariance(const Rigid3& t, const Matrix6d& covariance) {
  // T⁻¹ = [Rᵀ | −Rᵀt]. With R' = Exp(δφ)R: R'ᵀ = Rᵀ Exp(−δφ) = Exp(−Rᵀδφ) Rᵀ, and
  // −R'ᵀ(t+δt) = −Rᵀ(t + δt − δφ × t) = −Rᵀt − Rᵀδt − Rᵀ[t]× δφ.
  const Eigen::Matrix3d rt = t.rotation.conjugate().toRotationMatrix();
  Matrix6d j = Matrix6d::Zero();
  j.topLeftCorner<3, 3>() = -rt;
  j.topRightCorner<3, 3>() = -rt * skew(t.translation);
  j.bottomRightCorner<3, 3>() = -rt;
  return j * covariance * j.transpose();
}

}  // namespace waymark
