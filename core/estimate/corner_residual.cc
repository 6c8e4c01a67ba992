#include "core/estimate/corner_residual.h"

namespace waymark {

CornerChain::CornerChain(const CameraModel& camera, const Rigid3& cam_from_rig,
                         const Rigid3& world_from_rig, const Rigid3& world_from_marker)
    : camera_(camera),
      cam_from_world_rotation_(
          (cam_from_rig.rotation * world_from_rig.rotation.conjugate()).toRotationMatrix()),
      rig_in_cam_(cam_from_rig.translation),
      cam_from_rig_rotation_(cam_from_rig.rotation),
      world_from_marker_rotation_(world_from_marker.rotation.toRotationMatrix()),
      marker_from_rig_in_world_(world_from_marker.translation - world_from_rig.translation) {}

std::optional<Eigen::Vector2d> corner_residual(const CornerChain& chain,
                                               const Eigen::Vector3d& x_in_marker,
                                               const Eigen::Vector2d& observed_px,
                                               CornerJacobians* jacobians,
                                               CalibrationJacobians* calibration) {
  const Eigen::Vector3d turned = chain.world_from_marker_rotation_ * x_in_marker;
  const Eigen::Vector3d from_rig = turned + chain.marker_from_rig_in_world_;
  const Eigen::Vector3d x_in_cam = chain.cam_from_world_rotation_ * from_rig + chain.rig_in_cam_;

  if (jacobians == nullptr) {
    const auto pixel = chain.camera_.project(x_in_cam);
    if (!pixel) return std::nullopt;
    return observed_px - *pixel;
  }

  const auto projection = chain.camera_.project_with_jacobian(
      x_in_cam, calibration == nullptr ? nullptr : &calibration->d_intrinsics);
  if (!projection) return std::nullopt;
  // Equation (3): dχ/dx_in_world; the minus is the one the paper leaves out.
  const Eigen::Matrix<double, 2, 3> d_world =
      -projection->d_pixel_d_point * chain.cam_from_world_rotation_;
  // world_from_marker ⊞ δ moves the corner by δt + δφ × turned.
  jacobians->d_marker.leftCols<3>() = d_world;
  jacobians->d_marker.rightCols<3>().noalias() = -d_world * skew(turned);
  // world_from_rig ⊞ δ moves the corner, as the rig sees it, the opposite way (eq. 6).
  jacobians->d_rig.leftCols<3>() = -d_world;
  jacobians->d_rig.rightCols<3>().noalias() = d_world * skew(from_rig);
  if (calibration != nullptr) {
    // rig_from_cam ⊞ δ moves the corner, as the camera sees it, by −R(δt + δφ × (x_in_rig − t)).
    const Eigen::Matrix3d cam_from_rig = chain.cam_from_rig_rotation_.toRotationMatrix();
    const Eigen::Matrix<double, 2, 3> d_rig_axes = projection->d_pixel_d_point * cam_from_rig;
    calibration->d_extrinsics.leftCols<3>() = d_rig_axes;
    calibration->d_extrinsics.rightCols<3>().noalias() =
        -d_rig_axes * skew(cam_from_rig.transpose() * x_in_cam);
    calibration->d_intrinsics = -calibration->d_intrinsics;
  }
  return observed_px - projection->pixel;
}

}  // namespace waymark
