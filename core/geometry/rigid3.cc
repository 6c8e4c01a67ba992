#include "core/geometry/rigid3.h"

namespace waymark {

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
