#pragma once

#include <memory>
#include <vector>

#include "mapbuilder/bundle/joint_problem.h"

namespace waymark {

/// fu fv pu pv and the four coefficients.
using Intrinsics = Eigen::Matrix<double, 8, 1>;
[[nodiscard]] Intrinsics intrinsics_of(const CameraModel& camera);

/// Holds one direction of the cameras' calibration at its stated value: the residual is
/// Σ extrinsics_c · (rig_from_cam ⊟ stated) + intrinsics_c · (parameters − stated), in units of the
/// weights' limits, over a hundredth. Per camera of all rigs.
[[nodiscard]] std::unique_ptr<KeptFactor> direction_hold(const JointProblem& problem,
                                                         const std::vector<RigCamera>& stated,
                                                         const std::vector<Vector6d>& extrinsics,
                                                         const std::vector<Intrinsics>& intrinsics);

}  // namespace waymark
