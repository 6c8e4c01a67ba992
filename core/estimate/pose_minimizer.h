#pragma once

#include <algorithm>
#include <optional>

#include "core/geometry/rigid3.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {

/// A pose problem's quadratic approximation at one pose.
struct PoseEquations {
  Matrix6d hessian = Matrix6d::Zero();   ///< Σ Jᵀ w J, Rigid3's tangent
  Vector6d gradient = Vector6d::Zero();  ///< Σ Jᵀ w r
  double cost = 0;                       ///< Σ ρ, sigmas²
  int corners = 0;                       ///< corners that could be projected
};

/// A local optimum of a pose problem.
struct PoseOptimum {
  Rigid3 pose;
  double cost = 0;
  /// Inverse Hessian at the optimum; none where the observations leave some direction free: all of
  /// them gross, too few, or all from afar.
  std::optional<Matrix6d> covariance;
};

/// Inverse of a pose's Hessian; nullopt where it has none that could be told from rounding.
[[nodiscard]] std::optional<Matrix6d> pose_covariance(const Matrix6d& hessian);

/// Levenberg–Marquardt over one pose. `linearize(pose)` gives the PoseEquations there; steps that
/// raise the cost are taken back. Ends when a step promises less than 1e-7 sigmas². nullopt when
/// fewer than three corners can be projected at the start. No allocation.
template <typename Linearize>
[[nodiscard]] std::optional<PoseOptimum> minimize_pose(const Rigid3& start, int max_iterations,
                                                       const Linearize& linearize) {
  constexpr double kNegligibleDecrease = 1e-7;
  Rigid3 pose = start;
  PoseEquations here = linearize(pose);
  if (here.corners < 3) return std::nullopt;
  double damping = 1e-4;
  for (int i = 0; i < max_iterations; ++i) {
    Matrix6d damped = here.hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    const Vector6d step = -SymmetricFactor<6>(damped).solve(here.gradient);
    if (!step.allFinite()) break;
    const double promised = -step.dot(here.gradient);
    const Rigid3 next = pose.plus(step);
    const PoseEquations there = linearize(next);
    const bool better = there.corners >= 3 && there.cost <= here.cost;
    if (better) {
      pose = next;
      here = there;
      damping = std::max(1e-9, damping * 0.2);
    } else {
      damping = std::max(damping * 8.0, 1e-6);
    }
    if (promised < kNegligibleDecrease || damping > 1e12) break;
  }
  return PoseOptimum{pose, here.cost, pose_covariance(here.hessian)};
}

}  // namespace waymark
