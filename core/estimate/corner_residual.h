#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/camera/camera_model.h"
#include "core/geometry/rigid3.h"

namespace waymark {

using Jacobian26 = Eigen::Matrix<double, 2, 6>;

/// Where an observation stands in the chain marker → world → rig → cam → image, with what its four
/// corners share already composed.
class CornerChain {
 public:
  CornerChain(const CameraModel& camera, const Rigid3& cam_from_rig, const Rigid3& world_from_rig,
              const Rigid3& world_from_marker);

 private:
  friend std::optional<Eigen::Vector2d> corner_residual(const CornerChain&, const Eigen::Vector3d&,
                                                        const Eigen::Vector2d&,
                                                        struct CornerJacobians*,
                                                        struct CalibrationJacobians*);
  const CameraModel& camera_;
  Eigen::Matrix3d cam_from_world_rotation_;
  Eigen::Vector3d rig_in_cam_;  ///< the rig's origin in the camera frame (m)
  Eigen::Quaterniond cam_from_rig_rotation_;
  Eigen::Matrix3d world_from_marker_rotation_;
  Eigen::Vector3d marker_from_rig_in_world_;  ///< marker's centre less rig's origin, world axes (m)
};

/// What a corner residual may be differentiated by. Tangents are those of Rigid3: translation (m)
/// then rotation (rad), in world axes.
struct CornerJacobians {
  Jacobian26 d_marker;  ///< by world_from_marker, eqs. 2–3 (with the minus of χ = x − π)
  Jacobian26 d_rig;     ///< by world_from_rig, eqs. 5–6 (likewise; of the inverse motion)
};

/// What a corner residual may be differentiated by when the rig itself is in question.
struct CalibrationJacobians {
  Jacobian26 d_extrinsics;          ///< by rig_from_cam, Rigid3's tangent in rig axes
  IntrinsicsJacobian d_intrinsics;  ///< by fu fv pu pv and the coefficients
};

/// The one corner residual of Waymark, χ = x − π(cam_from_rig · world_from_rig⁻¹ ·
/// world_from_marker · X) (px), eqs. 1 and 4: serves marker adjustment (d_marker), camera-group
/// adjustment (d_rig) and, with the marker fixed, localization. `x_in_marker` (m) from
/// marker_corners(); `jacobians` may be null. nullopt when the corner lies outside the camera's
/// domain (behind it, say): then there is no residual, never a zero one. `calibration` (optional)
/// is filled only together with `jacobians`.
[[nodiscard]] std::optional<Eigen::Vector2d> corner_residual(
    const CornerChain& chain, const Eigen::Vector3d& x_in_marker,
    const Eigen::Vector2d& observed_px, CornerJacobians* jacobians,
    CalibrationJacobians* calibration = nullptr);

}  // namespace waymark
