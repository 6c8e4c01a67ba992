#include "locd/pose/robust_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

RigPoseOptions solver_options() {
  RigPoseOptions options;
  options.bounded_score_sigmas = 10.0;
  options.max_refined = 3;
  options.max_iterations = 20;
  return options;
}

bool timed(const SetObservation& o) {
  return std::any_of(o.after_s.begin(), o.after_s.end(), [](double t) { return t != 0; });
}

}  // namespace

Status RobustPoseOptions::check() const {
  return RangeCheck()
      .field("inlier_sigmas", inlier_sigmas, {4, 20})
      .field("tukey_sigmas", tukey_sigmas, {6, 40})
      .field("seed_observations", seed_observations, {1, 64})
      .field("all_seed_observations", all_seed_observations, {1, 512})
      .status();
}

RobustPose::RobustPose(const Rig& rig, const MapIndex& map, const RobustPoseOptions& options)
    : map_(map),
      cameras_(static_cast<int>(rig.cameras.size())),
      options_(options),
      solver_(rig, solver_options()),
      covariance_(map_, solver_) {
  WAYMARK_CHECK(options.check().has_value());
  marker_verdicts_.reserve(map.size());
}

std::optional<PoseSolution> RobustPose::solve(std::span<SetObservation> observations,
                                              const std::optional<Rigid3>& predicted,
                                              const VelocityPrior& velocity,
                                              double model_sigma_px) {
  whiten_roughly(observations, velocity, model_sigma_px);
  if (predicted) move_to_set_instant(observations, *predicted, velocity.velocity);
  const auto estimate = find_pose(observations, predicted);
  if (!estimate) return std::nullopt;

  PoseSolution solution;
  solution.ambiguous = estimate->ambiguous;
  Rigid3 pose = estimate->best.pose;
  VelocityPrior believed = velocity;
  const bool in_motion = std::any_of(observations.begin(), observations.end(), timed);
  MotionStep step;
  // The set's own say about the velocity, twice: then inliers and velocity have settled.
  for (int round = 0; round < (in_motion ? 3 : 1); ++round) {
    if (!polish(observations, pose, believed, model_sigma_px) &&
        !(round == 0 && try_poses_of_cameras(observations, pose, believed, model_sigma_px))) {
      return std::nullopt;
    }
    if (round == 0 && try_pose_of_outliers(observations, pose, believed, model_sigma_px)) {
      solution.ambiguous = true;
    }
    if (!in_motion) break;
    whiten(observations, pose, Matrix6d::Zero(), model_sigma_px);
    solution.motion = motion_evidence(observations, map_, solver_, pose, believed.velocity);
    step = motion_step(solution.motion, velocity);
    if (!step.pose.allFinite() || !step.velocity.allFinite()) return std::nullopt;
    pose = pose.plus(step.pose);
    believed = {believed.velocity + step.velocity, step.velocity_covariance};
    move_to_set_instant(observations, pose, believed.velocity);
  }
  solution.motion = motion_evidence(observations, map_, solver_, pose, believed.velocity);
  step = motion_step(solution.motion, velocity);
  solution.world_from_rig = pose;
  solution.velocity = believed.velocity;
  solution.velocity_covariance = in_motion ? step.velocity_covariance : velocity.covariance;
  solution.noise_covariance = SymmetricFactor<6>(solution.motion.of_pose).inverse();
  solution.covariance = covariance_.of(observations, pose, solution.motion, step, model_sigma_px);
  if (in_motion) whiten(observations, pose, solution.velocity_covariance, model_sigma_px);
  classify(observations, pose);
  count_markers(observations, solution);
  if (solution.inliers == 0 || !solution.covariance.allFinite()) return std::nullopt;
  return solution;
}

std::optional<RigPoseEstimate> RobustPose::find_pose(std::span<SetObservation> observations,
                                                     const std::optional<Rigid3>& predicted) {
  const auto few = static_cast<std::size_t>(options_.seed_observations);
  const auto many = static_cast<std::size_t>(options_.all_seed_observations);
  const std::span<const Rigid3> priors =
      predicted ? std::span(&*predicted, 1) : std::span<const Rigid3>();
  seed(observations, few);
  collect(observations, Which::all);
  auto estimate = solver_.solve(fixed_, priors);
  const auto explained = [&] {
    return 2 * classify(observations, estimate->best.pose) > static_cast<int>(observations.size());
  };
  if (observations.size() > few && !(estimate && explained())) {
    // The largest may all be wrong.
    seed(observations, many);
    estimate = solver_.solve(fixed_, priors);
  }
  return estimate;
}

/// From a pose nearby to the least-squares optimum over the inliers; false when there are none.
bool RobustPose::polish(std::span<SetObservation> observations, Rigid3& pose,
                        const VelocityPrior& believed, double model_sigma_px) {
  move_to_set_instant(observations, pose, believed.velocity);
  whiten(observations, pose, believed.covariance, model_sigma_px);
  collect(observations, Which::all);
  if (const auto tukey = solver_.refine(fixed_, pose, {Loss::tukey, options_.tukey_sigmas})) {
    pose = tukey->pose;
  }
  // Who is an inlier changes with the pose, hardly ever twice.
  int before = -1;
  for (int round = 0; round < 3; ++round) {
    move_to_set_instant(observations, pose, believed.velocity);
    const int inliers = classify(observations, pose);
    if (inliers == 0) return false;
    if (inliers == before) return true;
    before = inliers;
    collect(observations, Which::inliers);
    const auto least_squares = solver_.refine(fixed_, pose, {.loss = Loss::squared});
    if (!least_squares) return false;
    pose = least_squares->pose;
  }
  return true;
}

/// When cameras of equal weight contradict each other, the pose between them explains none: then
/// each one's own pose is asked, and that which explains most of all is taken. False when none
/// explains anything.
bool RobustPose::try_poses_of_cameras(std::span<SetObservation> observations, Rigid3& pose,
                                      const VelocityPrior& believed, double model_sigma_px) {
  constexpr std::size_t kFewest = 2;  // a single marker can be seen in two ways
  const Rigid3 between = pose;
  double best = std::numeric_limits<double>::infinity();
  for (int camera = 0; camera < cameras_; ++camera) {
    fixed_.clear();
    for (const SetObservation& o : observations) {
      if (o.observation.camera != camera) continue;
      fixed_.push_back({&o.observation, map_.marker(o.map_index).world_from_marker});
    }
    if (fixed_.size() < kFewest) continue;
    const auto own = solver_.refine(fixed_, between);
    if (!own) continue;
    Rigid3 candidate = own->pose;
    if (!polish(observations, candidate, believed, model_sigma_px)) continue;
    collect(observations, Which::all);
    const double rank = solver_.rank(fixed_, candidate);
    if (rank >= best) continue;
    best = rank;
    pose = candidate;
  }
  return std::isfinite(best) && polish(observations, pose, believed, model_sigma_px);
}

/// When a quarter or more are outliers: what pose do they give among themselves? It is taken when
/// it explains more of all than the other did. True when both explain the set about as well.
bool RobustPose::try_pose_of_outliers(std::span<SetObservation> observations, Rigid3& pose,
                                      const VelocityPrior& believed, double model_sigma_px) {
  constexpr double kAlike = 20.0;  // sigmas², as RigPoseOptions::ambiguity_gap
  collect(observations, Which::outliers);
  if (4 * fixed_.size() < observations.size() || fixed_.empty()) return false;
  const auto theirs = solver_.refine(fixed_, pose);
  if (!theirs) return false;
  collect(observations, Which::all);
  const double ours = solver_.rank(fixed_, pose);
  Rigid3 other = theirs->pose;
  const bool exists = polish(observations, other, believed, model_sigma_px);
  collect(observations, Which::all);
  const double gain = exists ? ours - solver_.rank(fixed_, other) : -2 * kAlike;
  if (gain > 0) {
    pose = other;
  } else if (!polish(observations, pose, believed, model_sigma_px)) {
    return true;
  }
  const bool distinct = angle_between_rad(other.rotation, pose.rotation) > 0.002 ||
                        (other.translation - pose.translation).norm() > 0.01;
  return exists && std::abs(gain) < kAlike && (gain > 0 || distinct);
}

void RobustPose::hold_against(std::span<SetObservation> observations, const PoseSolution& solution,
                              double model_sigma_px) const {
  move_to_set_instant(observations, solution.world_from_rig, solution.velocity);
  whiten(observations, solution.world_from_rig, solution.velocity_covariance, model_sigma_px);
  classify(observations, solution.world_from_rig);
}

/// Before a pose is known: the detector's and the model's errors, and about what an unknown motion
/// does to a corner some metres away.
void RobustPose::whiten_roughly(std::span<SetObservation> observations,
                                const VelocityPrior& velocity, double model_sigma_px) const {
  constexpr double kNear_m = 3.0;
  const double turning2 = velocity.covariance.bottomRightCorner<3, 3>().trace() / 3;
  const double moving2 = velocity.covariance.topLeftCorner<3, 3>().trace() / 3;
  for (SetObservation& o : observations) {
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const double focal_px = solver_.model(camera).parameters().fu_px;
    for (std::size_t i = 0; i < 4; ++i) {
      const double t_px = o.after_s[i] * focal_px;
      const double motion2 = t_px * t_px * (turning2 + moving2 / (kNear_m * kNear_m));
      const double added = model_sigma_px * model_sigma_px + motion2;
      o.observation.whitening[i] =
          whitening_from_covariance(o.stated[i] + added * Eigen::Matrix2d::Identity());
    }
    o.observation.corners_px = o.detected_px;
  }
}

/// With a pose: the map's and the velocity's errors too, as they show in each corner.
void RobustPose::whiten(std::span<SetObservation> observations, const Rigid3& pose,
                        const Matrix6d& velocity_covariance, double model_sigma_px) const {
  const Eigen::Matrix2d model = model_sigma_px * model_sigma_px * Eigen::Matrix2d::Identity();
  for (SetObservation& o : observations) {
    const MapMarker& marker = map_.marker(o.map_index);
    const auto corners = linearize_corners(
        o.observation, solver_.geometry(o.observation.camera, pose, marker.world_from_marker));
    if (!corners) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const CornerJacobians& jacobians = (*corners)[i].jacobians;
      Eigen::Matrix2d covariance = o.stated[i] + model;
      covariance += jacobians.d_marker * marker.covariance * jacobians.d_marker.transpose();
      const double t = o.after_s[i];
      if (t != 0) {
        covariance += t * t * jacobians.d_rig * velocity_covariance * jacobians.d_rig.transpose();
      }
      o.observation.whitening[i] = whitening_from_covariance(covariance);
    }
  }
}

void RobustPose::move_to_set_instant(std::span<SetObservation> observations, const Rigid3& pose,
                                     const Vector6d& velocity) const {
  const Rigid3 rig_from_world = pose.inverse();
  for (SetObservation& o : observations) {
    o.observation.corners_px = o.detected_px;
    if (velocity.isZero() || !timed(o)) continue;
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

void RobustPose::collect(std::span<const SetObservation> observations, Which which) {
  fixed_.clear();
  for (const SetObservation& o : observations) {
    if (which != Which::all && o.inlier != (which == Which::inliers)) continue;
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
