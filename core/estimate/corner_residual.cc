#include "core/estimate/corner_residual.h"

namespace waymark {

std::optional<Eigen::Vector2d> corner_residual(const CornerGeometry& geometry,
                                               const Eigen::Vector2d& observed_px,
                                               CornerJacobians* jacobians) {
  const Eigen::Vector3d turned = geometry.world_from_marker.rotation * geometry.x_in_marker;
  const Eigen::Vector3d x_in_world = turned + geometry.world_from_marker.translation;
  const Eigen::Vector3d from_rig = x_in_world - geometry.world_from_rig.translation;
  const Eigen::Vector3d x_in_rig = geometry.world_from_rig.rotation.conjugate() * from_rig;
  const Eigen::Vector3d x_in_cam = geometry.cam_from_rig * x_in_rig;

  if (jacobians == nullptr) {
    const auto pixel = geometry.camera->project(x_in_cam);
    if (!pixel) return std::nullopt;
    return observed_px - *pixel;
  }

  const auto projection = geometry.camera->project_with_jacobian(x_in_cam);
  if (!projection) return std::nullopt;
  const Eigen::Matrix3d cam_from_world_rotation =
      (geometry.cam_from_rig.rotation * geometry.world_from_rig.rotation.conjugate())
          .toRotationMatrix();
  // Equation (3): dχ/dx_in_world; the minus is the one the paper leaves out.
  const Eigen::Matrix<double, 2, 3> d_world =
      -projection->d_pixel_d_point * cam_from_world_rotation;
  // world_from_marker ⊞ δ moves the corner by δt + δφ × turned.
  jacobians->d_marker.leftCols<3>() = d_world;
  jacobians->d_marker.rightCols<3>() = -d_world * skew(turned);
  // world_from_rig ⊞ δ moves the corner, as the rig sees it, the opposite way (eq. 6).
  jacobians->d_rig.leftCols<3>() = -d_world;
  jacobians->d_rig.rightCols<3>() = d_world * skew(from_rig);
  return observed_px - projection->pixel;
}

}  // namespace waymark
