#include "core/estimate/marker_observation.h"

#include <utility>

namespace waymark {
namespace {

constexpr double kUnprojectable = 1e4 * 1e4;  ///< sigmas²

CornerChain chain_of(const ObservationGeometry& geometry) {
  return {*geometry.camera, geometry.cam_from_rig, geometry.world_from_rig,
          geometry.world_from_marker};
}

/// Corner i of an observation; false: it can't be projected.
bool linearize(const MarkerObservation& observation, const CornerChain& chain, std::size_t i,
               const Eigen::Vector3d& x_in_marker, LinearizedCorner& corner) {
  const auto residual =
      corner_residual(chain, x_in_marker, observation.corners_px[i], &corner.jacobians);
  if (!residual) return false;
  corner.residual_px = *residual;
  corner.residual = observation.whitening[i] * *residual;
  return true;
}

}  // namespace

Status ObservationLoss::check() const {
  return RangeCheck().field("scale_sigmas", scale_sigmas, kScaleSigmas).status();
}

double gross_residual_px(const CameraModel& camera) {
  return 0.5 * std::hypot(camera.parameters().width_px, camera.parameters().height_px);
}

Eigen::Matrix2d whitening_from_covariance(const Eigen::Matrix2d& covariance) {
  const double l00 = std::sqrt(covariance(0, 0));
  const double l10 = covariance(1, 0) / l00;
  const double l11 = std::sqrt(covariance(1, 1) - l10 * l10);
  Eigen::Matrix2d w;
  w << 1.0 / l00, 0.0, -l10 / (l00 * l11), 1.0 / l11;
  return w;
}

std::optional<std::array<Eigen::Vector2d, 4>> corner_residuals(const MarkerObservation& observation,
                                                               const CameraModel& camera,
                                                               const Rigid3& cam_from_marker) {
  const Eigen::Matrix3d rotation = cam_from_marker.rotation.toRotationMatrix();
  std::array<Eigen::Vector2d, 4> residuals;
  const auto corners = marker_corners(observation.size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.project(rotation * corners[i] + cam_from_marker.translation);
    if (!pixel) return std::nullopt;
    residuals[i] = observation.corners_px[i] - *pixel;
  }
  return residuals;
}

double squared_residual(const MarkerObservation& observation, const CameraModel& camera,
                        const Rigid3& cam_from_marker) {
  const auto residuals = corner_residuals(observation, camera, cam_from_marker);
  if (!residuals) return kUnprojectable;
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += (observation.whitening[i] * (*residuals)[i]).squaredNorm();
  }
  return sum;
}

std::optional<std::array<LinearizedCorner, 4>> linearize_corners(
    const MarkerObservation& observation, const ObservationGeometry& geometry,
    const Eigen::Vector2d& times) {
  const CornerChain chain = chain_of(geometry);
  auto x_in_marker = marker_corners(observation.size_m);
  std::optional<std::array<LinearizedCorner, 4>> corners(std::in_place);
  for (std::size_t i = 0; i < 4; ++i) {
    x_in_marker[i].head<2>().array() *= times.array();
    if (!linearize(observation, chain, i, x_in_marker[i], (*corners)[i])) return std::nullopt;
  }
  return corners;
}

void add_observation(const MarkerObservation& observation, const ObservationGeometry& geometry,
                     const ObservationLoss& loss, FreePose free, PoseEquations& equations) {
  const CornerChain chain = chain_of(geometry);
  const auto x_in_marker = marker_corners(observation.size_m);
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  const double gross_px = gross_residual_px(*geometry.camera);
  bool gross = false;
  double s = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    // One at a time: to keep all four costs locd's solve a twentieth.
    LinearizedCorner corner;
    if (!linearize(observation, chain, i, x_in_marker[i], corner)) {
      equations.cost += robust_cost(loss.loss, loss.scale_sigmas, kUnprojectable);
      return;
    }
    const Jacobian26 j =
        observation.whitening[i] *
        (free == FreePose::rig ? corner.jacobians.d_rig : corner.jacobians.d_marker);
    hessian.noalias() += j.transpose() * j;
    gradient.noalias() += j.transpose() * corner.residual;
    s += corner.residual.squaredNorm();
    gross = gross || corner.residual_px.norm() > gross_px;
  }
  equations.cost += robust_cost(loss.loss, loss.scale_sigmas, s);
  equations.corners += 4;
  if (gross) return;
  const double weight = robust_weight(loss.loss, loss.scale_sigmas, s);
  equations.hessian += weight * hessian;
  equations.gradient += weight * gradient;
}

}  // namespace waymark
