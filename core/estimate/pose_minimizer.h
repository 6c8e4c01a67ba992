#pragma once

#include <optional>

#include "core/geometry/levenberg_marquardt.h"
#include "core/geometry/rigid3.h"

namespace waymark {

/// A pose problem's, in Rigid3's tangent.
using PoseEquations = NormalEquations<6>;

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

/// Levenberg–Marquardt over one pose; `linearize(pose)` gives the PoseEquations there. Nullopt
/// where `minimize` gives none.
template <typename Linearize, typename GivenUp = ToTheEnd>
[[nodiscard]] std::optional<PoseOptimum> minimize_pose(const Rigid3& start, int max_iterations,
                                                       const Linearize& linearize,
                                                       const GivenUp& given_up = {}) {
  const auto optimum = minimize<6>(
      start, {.max_iterations = max_iterations}, linearize,
      [](const Rigid3& pose, const Vector6d& step) { return pose.plus(step); }, given_up);
  if (!optimum) return std::nullopt;
  const PoseEquations& equations = optimum->equations;
  return PoseOptimum{optimum->place, equations.cost, pose_covariance(equations.hessian)};
}

}  // namespace waymark
