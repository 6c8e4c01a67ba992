#include "locd/robust_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/estimate/corner_residual.h"

namespace waymark {
namespace {

RigPoseOptions solver_options() {
  RigPoseOptions options;
  options.bounded_score_sigmas = 10.0;
  options.max_refined = 3;
  options.max_iterations = 20;
  return options;
}

Rigid3 moved(const Rigid3& world_from_rig, const Vector6d& velocity, double seconds) {
  return world_from_rig.plus(velocity * seconds);
}

}  // namespace

RobustPose::RobustPose(const Rig& rig, const MapIndex& map, const RobustPoseOptions& options)
    : map_(map), options_(options), solver_(rig, solver_options()) {}

std::optional<PoseSolution> RobustPose::solve(std::span<SetObservation> observations,
                                              const std::optional<MotionPrediction>& prior,
                                              const Vector6d& velocity,
                                              const Matrix6d& velocity_covariance,
                                              double model_sigma_px) {
  whiten(observations, model_sigma_px);
  if (prior) to_set_instant(observations, prior->world_from_rig, velocity);
  const auto few = static_cast<std::size_t>(options_.seed_observations);
  const auto many = static_cast<std::size_t>(options_.all_seed_observations);
  seed(observations, few);
  collect(observations, false);
  const std::span<const Rigid3> priors =
      prior ? std::span(&prior->world_from_rig, 1) : std::span<const Rigid3>();
  auto estimate = solver_.solve(fixed_, priors);
  const bool explained = estimate && 2 * classify(observations, estimate->best.pose) >
                                         static_cast<int>(observations.size());
  if (!explained && observations.size() > few) {
    // The largest may all be wrong.
    seed(observations, many);
    estimate = solver_.solve(fixed_, priors);
  }
  if (!estimate) return std::nullopt;

  PoseSolution solution;
  solution.ambiguous = estimate->ambiguous;
  Rigid3 pose = estimate->best.pose;
  to_set_instant(observations, pose, velocity);
  whiten_with_map(observations, pose, model_sigma_px);
  if (const auto tukey = solver_.refine(fixed_, pose, {Loss::tukey, options_.tukey_sigmas})) {
    pose = tukey->pose;
  }
  // Who is an inlier changes with the pose, hardly ever twice.
  for (int round = 0; round < 3; ++round) {
    to_set_instant(observations, pose, velocity);
    const int before = solution.inliers;
    solution.inliers = classify(observations, pose);
    if (solution.inliers == 0) return std::nullopt;
    collect(observations, true);
    const auto least_squares = solver_.refine(fixed_, pose, {Loss::squared, 1.0});
    if (!least_squares) return std::nullopt;
    pose = least_squares->pose;
    if (round > 0 && solution.inliers == before) break;
  }
  solution.world_from_rig = pose;
  state_covariance(observations, velocity_covariance, model_sigma_px, solution);
  classify(observations, pose);
  count_markers(observations, solution);
  if (solution.inliers == 0 || !solution.covariance.allFinite()) return std::nullopt;
  return solution;
}

void RobustPose::hold_against(std::span<SetObservation> observations, const Rigid3& world_from_rig,
                              const Vector6d& velocity, double model_sigma_px) const {
  whiten(observations, model_sigma_px);
  to_set_instant(observations, world_from_rig, velocity);
  whiten_with_map(observations, world_from_rig, model_sigma_px);
  classify(observations, world_from_rig);
}

void RobustPose::whiten(std::span<SetObservation> observations, double model_sigma_px) const {
  const Eigen::Matrix2d model = model_sigma_px * model_sigma_px * Eigen::Matrix2d::Identity();
  for (SetObservation& o : observations) {
    for (std::size_t i = 0; i < 4; ++i) {
      o.observation.whitening[i] = whitening_from_covariance(o.stated[i] + model);
    }
    o.observation.corners_px = o.detected_px;
  }
}

void RobustPose::whiten_with_map(std::span<SetObservation> observations, const Rigid3& pose,
                                 double model_sigma_px) const {
  const Eigen::Matrix2d model = model_sigma_px * model_sigma_px * Eigen::Matrix2d::Identity();
  for (SetObservation& o : observations) {
    const MapMarker& marker = map_.marker(o.map_index);
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const CornerChain chain(solver_.model(camera), solver_.cam_from_rig(camera), pose,
                            marker.world_from_marker);
    const auto corners = marker_corners(marker.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      CornerJacobians jacobians;
      if (!corner_residual(chain, corners[i], o.observation.corners_px[i], &jacobians)) continue;
      const Eigen::Matrix2d of_map =
          jacobians.d_marker * marker.covariance * jacobians.d_marker.transpose();
      o.observation.whitening[i] = whitening_from_covariance(o.stated[i] + model + of_map);
    }
  }
}

void RobustPose::to_set_instant(std::span<SetObservation> observations, const Rigid3& pose,
                                const Vector6d& velocity) const {
  for (SetObservation& o : observations) {
    if (velocity.isZero() ||
        std::all_of(o.after_s.begin(), o.after_s.end(), [](double t) { return t == 0; })) {
      continue;
    }
    const MapMarker& marker = map_.marker(o.map_index);
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const Rigid3& cam_from_rig = solver_.cam_from_rig(camera);
    const CameraModel& model = solver_.model(camera);
    const auto corners = marker_corners(marker.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d x_in_world = marker.world_from_marker * corners[i];
      const auto now = model.project(cam_from_rig * (pose.inverse() * x_in_world));
      const auto then = model.project(cam_from_rig *
                                      (moved(pose, velocity, o.after_s[i]).inverse() * x_in_world));
      if (now && then) o.observation.corners_px[i] = o.detected_px[i] + (*now - *then);
    }
  }
}

void RobustPose::seed(std::span<SetObservation> observations, std::size_t count) {
  by_size_.clear();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    by_size_.emplace_back(-area_px2(observations[i].detected_px), i);
    observations[i].observation.ippe.reset();
  }
  const std::size_t seeds = std::min(count, by_size_.size());
  std::partial_sort(by_size_.begin(), by_size_.begin() + static_cast<std::ptrdiff_t>(seeds),
                    by_size_.end());
  for (std::size_t i = 0; i < seeds; ++i) {
    MarkerObservation& o = observations[by_size_[i].second].observation;
    o.ippe = solve_ippe(solver_.model(static_cast<std::size_t>(o.camera)), o.corners_px, o.size_m);
  }
}

void RobustPose::collect(std::span<SetObservation> observations, bool inliers_only) {
  fixed_.clear();
  for (const SetObservation& o : observations) {
    if (inliers_only && !o.inlier) continue;
    fixed_.push_back({&o.observation, map_.marker(o.map_index).world_from_marker});
  }
}

int RobustPose::classify(std::span<SetObservation> observations, const Rigid3& pose) const {
  const Rigid3 rig_from_world = pose.inverse();
  const double limit = options_.inlier_sigmas * options_.inlier_sigmas;
  int inliers = 0;
  for (SetObservation& o : observations) {
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const Rigid3 cam_from_marker = solver_.cam_from_rig(camera) *
                                   (rig_from_world * map_.marker(o.map_index).world_from_marker);
    o.sigmas_squared = squared_residual(o.observation, solver_.model(camera), cam_from_marker);
    o.inlier = o.sigmas_squared <= limit;
    inliers += o.inlier ? 1 : 0;
    const auto residuals = corner_residuals(o.observation, solver_.model(camera), cam_from_marker);
    double sum = 0;
    if (residuals) {
      for (const Eigen::Vector2d& r : *residuals) sum += r.squaredNorm();
    }
    o.rms_px = residuals ? std::sqrt(sum / 4.0) : std::numeric_limits<double>::quiet_NaN();
  }
  return inliers;
}

void RobustPose::state_covariance(std::span<const SetObservation> observations,
                                  const Matrix6d& velocity_covariance, double model_sigma_px,
                                  PoseSolution& solution) {
  const Rigid3& pose = solution.world_from_rig;
  const Eigen::Matrix2d model = model_sigma_px * model_sigma_px * Eigen::Matrix2d::Identity();
  Matrix6d hessian = Matrix6d::Zero();
  Matrix6d noise = Matrix6d::Zero();
  Matrix6d timed = Matrix6d::Zero();
  shares_.clear();
  for (const SetObservation& o : observations) {
    if (!o.inlier) continue;
    const MapMarker& marker = map_.marker(o.map_index);
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const CornerChain chain(solver_.model(camera), solver_.cam_from_rig(camera), pose,
                            marker.world_from_marker);
    auto share = std::find_if(shares_.begin(), shares_.end(),
                              [&](const MarkerShare& s) { return s.map_index == o.map_index; });
    if (share == shares_.end()) share = shares_.insert(share, {o.map_index, Matrix6d::Zero()});
    const auto corners = marker_corners(marker.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      CornerJacobians jacobians;
      if (!corner_residual(chain, corners[i], o.observation.corners_px[i], &jacobians)) continue;
      const Eigen::Matrix2d& w = o.observation.whitening[i];
      const Eigen::Matrix2d information = w.transpose() * w;
      const Eigen::Matrix<double, 6, 2> weighted = jacobians.d_rig.transpose() * information;
      const Matrix6d own = weighted * jacobians.d_rig;
      hessian += own;
      timed += o.after_s[i] * own;
      noise += weighted * (o.stated[i] + model) * weighted.transpose();
      share->gain += weighted * jacobians.d_marker;
    }
  }
  const Eigen::LDLT<Matrix6d> factor(hessian);
  const Matrix6d inverse = factor.solve(Matrix6d::Identity());
  Matrix6d covariance = inverse * noise * inverse;
  const Matrix6d per_velocity = inverse * timed;
  covariance += per_velocity * velocity_covariance * per_velocity.transpose();
  // Cov(Σ eₘ) ≤ Σ Cov(eₘ)/wₘ for any correlations and weights that sum to 1; wₘ ∝ √tr is best.
  double roots = 0;
  for (MarkerShare& share : shares_) {
    const Matrix6d gain = inverse * share.gain;
    share.gain = gain * map_.marker(share.map_index).covariance * gain.transpose();
    roots += std::sqrt(std::max(share.gain.trace(), 0.0));
  }
  for (const MarkerShare& share : shares_) {
    const double root = std::sqrt(std::max(share.gain.trace(), 0.0));
    if (root > 0) covariance += roots / root * share.gain;
  }
  solution.covariance = 0.5 * (covariance + covariance.transpose());
  solution.noise_covariance = inverse;
}

void RobustPose::count_markers(std::span<const SetObservation> observations,
                               PoseSolution& solution) {
  marker_verdicts_.clear();
  solution.inliers = 0;
  for (const SetObservation& o : observations) {
    solution.inliers += o.inlier ? 1 : 0;
    const auto known =
        std::find_if(marker_verdicts_.begin(), marker_verdicts_.end(),
                     [&](const auto& verdict) { return verdict.first == o.map_index; });
    if (known == marker_verdicts_.end()) {
      marker_verdicts_.emplace_back(o.map_index, o.inlier);
    } else {
      known->second = known->second || o.inlier;
    }
  }
  for (const auto& [map_index, inlier] : marker_verdicts_) {
    ++(inlier ? solution.inlier_markers : solution.outlier_markers);
  }
}

}  // namespace waymark
