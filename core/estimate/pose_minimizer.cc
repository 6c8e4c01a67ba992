#include "core/estimate/pose_minimizer.h"

#include <Eigen/Cholesky>

namespace waymark {

std::optional<Matrix6d> pose_covariance(const Matrix6d& hessian) {
  constexpr double kRounding = 1e-14;
  if (!hessian.allFinite() || !(hessian.diagonal().minCoeff() > 0)) return std::nullopt;
  // Metres and radians are not to be compared: every direction by its own size.
  const Vector6d scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Matrix6d> factor(scale.asDiagonal() * hessian * scale.asDiagonal());
  if (factor.info() != Eigen::Success || !(factor.rcond() > kRounding)) return std::nullopt;
  return Matrix6d(scale.asDiagonal() * factor.solve(Matrix6d::Identity()) * scale.asDiagonal());
}

}  // namespace waymark
