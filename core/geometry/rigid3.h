#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/so3.h"

namespace waymark {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Rigid motion `target_from_source`: x_target = rotation · x_source + translation (m).
///
/// Tangent order everywhere: translation (m) first, rotation vector (rad) second, both in target
/// axes: T ⊞ [δt, δφ] = [Exp(δφ)·R | t + δt]. The 6×6 covariances of maps and poses are those of
/// this δ.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Rigid3 inverse() const;

  /// T ⊞ δ; the rotation is renormalized.
  [[nodiscard]] Rigid3 plus(const Vector6d& delta) const;

  /// δ with from.plus(δ) = *this.
  [[nodiscard]] Vector6d minus(const Rigid3& from) const;
};

[[nodiscard]] Rigid3 operator*(const Rigid3& a_from_b, const Rigid3& b_from_c);

[[nodiscard]] Eigen::Vector3d operator*(const Rigid3& a_from_b, const Eigen::Vector3d& x_in_b);

/// d(b_from_a ∘ T)'s tangent / d(T's tangent) for a fixed left factor `b_from_a`: both parts turn
/// with its rotation. Covariances transform as J Σ Jᵀ.
[[nodiscard]] Matrix6d left_motion_jacobian(const Rigid3& b_from_a);

/// Covariance of T⁻¹ given the covariance of T, both in the tangent order above.
[[nodiscard]] Matrix6d inverse_covariance(const Rigid3& t, const Matrix6d& covariance);

}  // namespace waymark
