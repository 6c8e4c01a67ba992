#include "core/estimate/error_columns.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/camera/lens_kind.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Columns of the lens: fu and fv as one share, principal point, the first coefficient that bends.
Eigen::Matrix<double, 2, 4> lens_columns(const CameraParameters& p, const IntrinsicsJacobian& d) {
  Eigen::Matrix<double, 2, 4> columns;
  // Of a straight lens the column is zero, whichever it is.
  const int bend = std::max(0, lens_kind(p.distortion).first_bend);
  columns << d.col(0) * p.fu_px + d.col(1) * p.fv_px, d.col(2), d.col(3), d.col(4 + bend);
  return columns;
}

}  // namespace

ErrorColumns ErrorColumns::none(double residual) {
  return {Vector8d::Constant(residual), Matrix86::Zero(), Matrix86::Zero(), Matrix86::Zero(),
          CalibrationColumns::Zero(),   Vector8d::Zero()};
}

void ErrorColumns::whiten(const Matrix8d& covariance) {
  const Eigen::LLT<Matrix8d> factor(covariance);
  const auto lower = factor.matrixL();
  lower.solveInPlace(residual);
  lower.solveInPlace(by_pose);
  lower.solveInPlace(by_velocity);
  lower.solveInPlace(by_marker);
  lower.solveInPlace(by_camera);
  lower.solveInPlace(by_size);
}

std::optional<ErrorColumns> error_columns(const MarkerObservation& observation,
                                          const ObservationGeometry& geometry,
                                          const CornerTimes& times, const Vector6d& velocity) {
  const CornerChain chain(*geometry.camera, geometry.cam_from_rig, geometry.world_from_rig,
                          geometry.world_from_marker);
  const auto x_in_marker = marker_corners(observation.size_m);
  const auto outward = outward_of(observation.corners_px);
  const Eigen::Matrix3d world_from_marker = geometry.world_from_marker.rotation.toRotationMatrix();
  ErrorColumns columns;
  for (std::size_t i = 0; i < 4; ++i) {
    CornerJacobians jacobians;
    CalibrationJacobians calibration;
    const auto residual =
        corner_residual(chain, x_in_marker[i], observation.corners_px[i], &jacobians, &calibration);
    if (!residual) return std::nullopt;
    const auto row = static_cast<Eigen::Index>(2 * i);
    columns.residual.segment<2>(row) = *residual;
    // χ falls by what the prediction rises.
    columns.by_pose.middleRows<2>(row) = -jacobians.d_rig;
    columns.by_velocity.middleRows<2>(row) = -times.after_s[i] * jacobians.d_rig;
    columns.by_marker.middleRows<2>(row) = -jacobians.d_marker;
    columns.by_size.segment<2>(row) =
        -jacobians.d_marker.leftCols<3>() * (world_from_marker * x_in_marker[i]);
    const Eigen::Vector2d moving = -jacobians.d_rig * velocity;
    columns.by_camera.middleRows<2>(row) << -calibration.d_extrinsics,
        -lens_columns(geometry.camera->parameters(), calibration.d_intrinsics), outward[i], moving,
        times.row[i] * moving;
  }
  return columns;
}

}  // namespace waymark
