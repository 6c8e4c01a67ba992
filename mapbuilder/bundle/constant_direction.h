#pragma once

#include <memory>

#include "mapbuilder/bundle/bundle_factor.h"

namespace waymark {

/// A direction of the cameras' calibration that the data can't tell: it stays where the rig file
/// has it. Weights in units of the limits that it is measured in.
struct ConstantDirection {
  IndexedVector<CameraIndex, Vector6d> extrinsics;  ///< of rig_from_cam's tangent
  IndexedVector<CameraIndex, IntrinsicsVector> intrinsics;
};

/// Holds it at the stated cameras' value: the residual is Σ extrinsics_c · (rig_from_cam ⊟ stated)
/// + intrinsics_c · (parameters − stated), over a hundredth of the limits.
[[nodiscard]] std::unique_ptr<BundleFactor> direction_factor(
    const ReducedLayout& layout, const IndexedVector<CameraIndex, RigCamera>& stated,
    const ConstantDirection& direction);

}  // namespace waymark
