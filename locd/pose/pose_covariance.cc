#include "locd/pose/pose_covariance.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

/// Calls `use(observation, corner, residual, jacobians)` for every corner of the inliers.
template <typename Use>
void for_each_corner(std::span<const SetObservation> observations, const MapIndex& map,
                     const RigPoseSolver& solver, const Rigid3& world_from_rig, const Use& use) {
  for (const SetObservation& o : observations) {
    if (!o.inlier) continue;
    const auto corners = linearize_corners(
        o.observation, solver.geometry(o.observation.camera, world_from_rig,
                                       map.marker(o.map_index).world_from_marker));
    if (!corners) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      use(o, i, (*corners)[i].residual_px, (*corners)[i].jacobians);
    }
  }
}

Eigen::Matrix<double, 6, 2> weighted_jacobian(const SetObservation& o, std::size_t corner,
                                              const CornerJacobians& jacobians) {
  const Eigen::Matrix2d& w = o.observation.whitening[corner];
  return jacobians.d_rig.transpose() * (w.transpose() * w);
}

}  // namespace

MotionEvidence motion_evidence(std::span<const SetObservation> observations, const MapIndex& map,
                               const RigPoseSolver& solver, const Rigid3& world_from_rig,
                               const Vector6d& velocity) {
  MotionEvidence evidence;
  evidence.world_from_rig = world_from_rig;
  evidence.velocity = velocity;
  for_each_corner(observations, map, solver, world_from_rig,
                  [&](const SetObservation& o, std::size_t i, const Eigen::Vector2d& residual,
                      const CornerJacobians& jacobians) {
                    const auto weighted = weighted_jacobian(o, i, jacobians);
                    const Matrix6d own = weighted * jacobians.d_rig;
                    const double t = o.after_s[i];
                    evidence.of_pose += own;
                    evidence.of_both += t * own;
                    evidence.of_velocity += t * t * own;
                    evidence.towards_pose -= weighted * residual;
                    evidence.towards_velocity -= t * weighted * residual;
                  });
  return evidence;
}

MotionStep motion_step(const MotionEvidence& evidence, const VelocityPrior& prior) {
  MotionStep step;
  const SymmetricFactor<6> pose_factor(evidence.of_pose);
  step.pose_per_velocity = -pose_factor.solve_columns(evidence.of_both);
  const SymmetricFactor<6> prior_factor(prior.covariance);
  const Matrix6d known =
      prior_factor.inverse() + evidence.of_velocity + evidence.of_both * step.pose_per_velocity;
  const Vector6d pull = evidence.towards_velocity +
                        step.pose_per_velocity.transpose() * evidence.towards_pose +
                        prior_factor.solve(prior.velocity - evidence.velocity);
  const SymmetricFactor<6> factor(known);
  step.velocity = factor.solve(pull);
  step.velocity_covariance = factor.inverse();
  step.pose = pose_factor.solve(evidence.towards_pose) + step.pose_per_velocity * step.velocity;
  return step;
}

Matrix6d covariance_of_unknown_times(std::span<const SetObservation> observations,
                                     std::span<const ConsideredObservation> considered,
                                     const ConsiderPose& pose, const CalibrationPrior& known) {
  const Matrix6d of_velocity = pose.velocity_covariance();
  Matrix6d lacking = Matrix6d::Zero();
  for (std::size_t camera = 0; camera < known.cameras(); ++camera) {
    // How the pose follows a motion that this camera alone shows, as a whole and row by row.
    Matrix6d whole = Matrix6d::Zero();
    Matrix6d by_row = Matrix6d::Zero();
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (!considered[i].used || considered[i].camera != camera) continue;
      const Matrix6d share = pose.gain(i) * considered[i].columns.by_pose;
      whole += share;
      by_row += mean_row(observations[i]) * share;
    }
    const CalibrationVector variances = known.variances_of(camera);
    lacking += variances[kStamp] * (whole * of_velocity * whole.transpose());
    lacking += variances[kReadout] * (by_row * of_velocity * by_row.transpose());
  }
  return 0.5 * (lacking + lacking.transpose());
}

MapDependence::MapDependence(const MapIndex& map) : map_(map) { shares_.reserve(map.size()); }

Matrix6d MapDependence::of(std::span<const SetObservation> observations,
                           std::span<const ConsideredObservation> considered,
                           const ConsiderPose& pose) {
  shares_.clear();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!considered[i].used) continue;
    const std::size_t map_index = observations[i].map_index;
    auto share = std::find_if(shares_.begin(), shares_.end(),
                              [&](const MarkerShare& s) { return s.map_index == map_index; });
    if (share == shares_.end()) share = shares_.insert(share, {map_index, Matrix6d::Zero()});
    share->matrix += pose.gain(i) * considered[i].columns.by_marker;
  }
  // Cov(Σ eₘ) ≤ Σ Cov(eₘ)/wₘ for any correlations and weights that sum to 1; wₘ ∝ √tr is best.
  double roots = 0;
  for (MarkerShare& share : shares_) {
    const Matrix6d gain = share.matrix;
    share.matrix = gain * map_.marker(share.map_index).covariance * gain.transpose();
    roots += std::sqrt(std::max(share.matrix.trace(), 0.0));
  }
  Matrix6d lacking = Matrix6d::Zero();
  for (const MarkerShare& share : shares_) {
    const double root = std::sqrt(std::max(share.matrix.trace(), 0.0));
    if (root > 0) lacking += (roots / root - 1) * share.matrix;
  }
  return 0.5 * (lacking + lacking.transpose());
}

}  // namespace waymark
