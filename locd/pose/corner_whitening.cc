#include "locd/pose/corner_whitening.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

/// While inliers are searched corners are taken for independent; what all four of a marker share
/// must not count four times.
constexpr double kShared = 4.0;
/// A usual distance of markers, where none is known.
constexpr double kNear_m = 3.0;

/// What a camera's calibration errors do to a corner somewhere in its image (px²).
double rough_variance_px2(const CalibrationPrior& prior, std::size_t camera, double focal_px) {
  constexpr double kSlope = 0.3;  // of a ray well off the axis
  const CalibrationVector v = prior.variances_of(camera);
  const double f2 = focal_px * focal_px;
  return f2 * (v[0] / (kNear_m * kNear_m) + v[3] + kSlope * kSlope * v[kFocal] +
               std::pow(kSlope, 6) * v[kFirstLens]) +
         v[kPrincipal] + v[kEdge];
}

}  // namespace

void CornerWhitening::whiten_roughly(std::span<SetObservation> observations,
                                     const VelocityPrior& velocity,
                                     const KnownErrors& known) const {
  const double turning2 = velocity.covariance.bottomRightCorner<3, 3>().trace() / 3;
  const double moving2 = velocity.covariance.topLeftCorner<3, 3>().trace() / 3;
  for (SetObservation& o : observations) {
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const double focal_px = solver_.model(camera).parameters().fu_px;
    const double constant2 = known.noise_px[camera] * known.noise_px[camera] +
                             kShared * rough_variance_px2(known.calibration, camera, focal_px);
    for (std::size_t i = 0; i < 4; ++i) {
      const double t_px = o.after_s[i] * focal_px;
      const double motion2 = t_px * t_px * (turning2 + moving2 / (kNear_m * kNear_m));
      const double added = constant2 + motion2;
      o.observation.whitening[i] =
          whitening_from_covariance(o.stated[i] + added * Eigen::Matrix2d::Identity());
    }
    o.observation.corners_px = o.detected_px;
  }
}

void CornerWhitening::whiten(std::span<SetObservation> observations, const Rigid3& pose,
                             const VelocityPrior& velocity, const KnownErrors& known) const {
  for (SetObservation& o : observations) {
    const MapMarker& marker = map_.marker(o.map_index);
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const auto columns = error_columns(
        o.observation, solver_.geometry(o.observation.camera, pose, marker.world_from_marker),
        {o.after_s, o.row}, velocity.velocity);
    if (!columns) continue;
    const CalibrationVector calibration = known.calibration.variances_of(camera);
    const double size = known.calibration.size_variance(known.calibration.size_of(marker));
    for (std::size_t i = 0; i < 4; ++i) {
      const auto row = static_cast<Eigen::Index>(2 * i);
      const auto by_marker = columns->by_marker.middleRows<2>(row);
      const auto by_camera = columns->by_camera.middleRows<2>(row);
      const auto by_size = columns->by_size.segment<2>(row);
      Eigen::Matrix2d covariance = by_marker * marker.metric() * by_marker.transpose();
      covariance += by_camera * calibration.asDiagonal() * by_camera.transpose();
      covariance += size * by_size * by_size.transpose();
      covariance *= kShared;
      covariance += o.stated[i];
      covariance.diagonal().array() += known.noise_px[camera] * known.noise_px[camera];
      if (o.after_s[i] != 0) {
        const auto by_velocity = columns->by_velocity.middleRows<2>(row);
        covariance += by_velocity * velocity.covariance * by_velocity.transpose();
      }
      o.observation.whitening[i] = whitening_from_covariance(covariance);
    }
  }
}

void CornerWhitening::move_to_set_instant(std::span<SetObservation> observations,
                                          const Rigid3& pose, const Vector6d& velocity) const {
  const Rigid3 rig_from_world = pose.inverse();
  for (SetObservation& o : observations) {
    o.observation.corners_px = o.detected_px;
    if (velocity.isZero() || !o.timed()) continue;
    const MapMarker& marker = map_.marker(o.map_index);
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const Rigid3& cam_from_rig = solver_.cam_from_rig(camera);
    const CameraModel& model = solver_.model(camera);
    const auto corners = marker_corners(marker.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d x_in_world = marker.world_from_marker * corners[i];
      const auto now = model.project(cam_from_rig * (rig_from_world * x_in_world));
      const Rigid3 rig_then = pose.plus(velocity * o.after_s[i]);
      const auto then = model.project(cam_from_rig * (rig_then.inverse() * x_in_world));
      if (now && then) o.observation.corners_px[i] += *now - *then;
    }
  }
}

}  // namespace waymark
