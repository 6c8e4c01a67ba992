#pragma once

#include <Eigen/Core>
#include <optional>

#include "locd/pose/robust_pose.h"

namespace waymark {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix86 = Eigen::Matrix<double, 8, 6>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

/// What an observation leaves at a pose: its four corners' residuals in sigmas, and how they change
/// with the rig's pose and with the marker's (Rigid3's tangents).
struct WhitenedResidual {
  Vector8d residual;
  Matrix86 by_rig;
  Matrix86 by_marker;
};

/// nullopt when a corner can't be projected there.
[[nodiscard]] std::optional<WhitenedResidual> whitened_residual(const SetObservation& observation,
                                                                const MapIndex& map,
                                                                const RigPoseSolver& solver,
                                                                const Rigid3& world_from_rig);

}  // namespace waymark
