#pragma once

#include <memory>
#include <vector>

#include "mapbuilder/mapping/joint_problem.h"

namespace waymark {

/// Holds one direction of the cameras' calibration at its stated value: the residual is
/// Σ extrinsics_c · (rig_from_cam ⊟ stated) + focal_c · (f − stated), in units of the weights'
/// limits, over a hundredth. Per camera of all rigs.
[[nodiscard]] std::unique_ptr<KeptFactor> direction_hold(const JointProblem& problem,
                                                         const std::vector<RigCamera>& stated,
                                                         const std::vector<Vector6d>& extrinsics,
                                                         const std::vector<Eigen::Vector2d>& focal);

}  // namespace waymark
