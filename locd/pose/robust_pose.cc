#include "locd/pose/robust_pose.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/geometry/symmetric_factor.h"
#include "locd/pose/pose_estimate.h"

namespace waymark {
namespace {

RigPoseOptions solver_options() {
  RigPoseOptions options;
  options.give_up_beside_known = true;
  options.bounded_score_sigmas = 10.0;
  options.max_refined = 3;
  options.max_iterations = 20;
  return options;
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

RobustPose::RobustPose(const Rig& rig, const MapIndex& map, const CalibrationPrior& prior,
                       const RobustPoseOptions& options)
    : map_(map),
      cameras_(static_cast<int>(rig.cameras.size())),
      options_(options),
      solver_(rig, solver_options()),
      whitening_(map, solver_),
      consider_(prior),
      dependence_(map) {
  WAYMARK_CHECK(options.check().has_value());
  marker_verdicts_.reserve(map.size());
  considered_.reserve(kMaxObservations);
  fixed_.reserve(kMaxObservations);
  solver_.reserve(kMaxObservations);
  consider_.reserve(kMaxObservations);
  by_size_.reserve(kMaxObservations);
}

std::optional<PoseSolution> RobustPose::solve(std::span<SetObservation> observations,
                                              const std::optional<Rigid3>& predicted,
                                              const VelocityPrior& velocity,
                                              const KnownErrors& known) {
  whitening_.whiten_roughly(observations, velocity, known);
  if (predicted) whitening_.move_to_set_instant(observations, *predicted, velocity.velocity);
  const auto estimate = find_pose(observations, predicted);
  if (!estimate) return std::nullopt;

  PoseSolution solution;
  solution.ambiguous = estimate->ambiguous;
  Rigid3 pose = estimate->best.pose;
  VelocityPrior believed = velocity;
  const bool in_motion = std::any_of(observations.begin(), observations.end(),
                                     [](const SetObservation& o) { return o.timed(); });
  MotionStep step;
  // The set's own say about the velocity, twice: then inliers and velocity have settled.
  for (int round = 0; round < (in_motion ? 3 : 1); ++round) {
    if (!polish(observations, pose, believed, known) &&
        !(round == 0 && try_poses_of_cameras(observations, pose, believed, known))) {
      return std::nullopt;
    }
    if (round == 0 && try_pose_of_outliers(observations, pose, believed, known)) {
      solution.ambiguous = true;
    }
    if (!in_motion) break;
    whitening_.whiten(observations, pose, {believed.velocity, Matrix6d::Zero()}, known);
    solution.motion = motion_evidence(observations, map_, solver_, pose, believed.velocity);
    step = motion_step(solution.motion, velocity);
    if (!step.pose.allFinite() || !step.velocity.allFinite()) return std::nullopt;
    pose = pose.plus(step.pose);
    believed = {believed.velocity + step.velocity, step.velocity_covariance};
    whitening_.move_to_set_instant(observations, pose, believed.velocity);
  }
  if (!refine(observations, velocity, known, pose)) return std::nullopt;
  solution.world_from_rig = pose;
  solution.velocity = velocity.velocity + consider_.velocity_step();
  solution.velocity_covariance = consider_.velocity_covariance();
  solution.covariance = consider_.covariance();
  if (!map_.independent()) {
    solution.covariance += dependence_.of(observations, considered_, consider_);
  }
  solution.covariance +=
      covariance_of_unknown_times(observations, considered_, consider_, known.learnt);
  solution.misfit = consider_.misfit();
  solution.freedoms = consider_.freedoms();
  whitening_.move_to_set_instant(observations, pose, solution.velocity);
  whitening_.whiten(observations, pose, {solution.velocity, Matrix6d::Zero()}, known);
  solution.motion = motion_evidence(observations, map_, solver_, pose, solution.velocity);
  solution.noise_covariance = SymmetricFactor<6>(solution.motion.of_pose).inverse();
  count_markers(observations, solution);
  if (solution.inliers == 0 || !solution.covariance.allFinite()) return std::nullopt;
  solution.rivals = rivals_agree(observations, solution);
  return solution;
}

bool RobustPose::rivals_agree(std::span<SetObservation> observations,
                              const PoseSolution& solution) {
  constexpr int kFewest = 3;
  if (solution.outlier_markers < kFewest ||
      3 * solution.outlier_markers < solution.inlier_markers) {
    return false;
  }
  collect(observations, Which::outliers);
  const auto theirs = solver_.solve(fixed_, std::span(&solution.world_from_rig, 1));
  if (!theirs) return false;
  const Rigid3 rig_from_world = theirs->best.pose.inverse();
  int agreeing = 0;
  for (const FixedMarkerObservation& fixed : fixed_) {
    const auto camera = static_cast<std::size_t>(fixed.observation->camera);
    const double s =
        squared_residual(*fixed.observation, solver_.model(camera),
                         solver_.cam_from_rig(camera) * (rig_from_world * fixed.world_from_marker));
    agreeing += s <= kInlierSigmas2 ? 1 : 0;
  }
  return agreeing >= kFewest && 3 * agreeing >= solution.inlier_markers;
}

ConsideredObservation RobustPose::linearize(const SetObservation& observation, const Rigid3& pose,
                                            const VelocityPrior& velocity,
                                            const KnownErrors& known) const {
  constexpr double kFitsNothing = 1e4;  // sigmas
  const MapMarker& marker = map_.marker(observation.map_index);
  ConsideredObservation considered;
  considered.camera = static_cast<std::size_t>(observation.observation.camera);
  considered.size = known.calibration.size_of(marker);
  considered.used = observation.inlier;
  // How much of the velocity's error a corner shows: by its instant as it was learnt to be.
  CornerTimes times{observation.after_s, observation.row};
  const double late_s = known.learnt.mean_of(considered.camera, kStamp);
  const double readout_s = known.learnt.mean_of(considered.camera, kReadout);
  for (std::size_t i = 0; i < 4; ++i) times.after_s[i] += late_s + times.row[i] * readout_s;
  const auto columns = error_columns(
      observation.observation,
      solver_.geometry(observation.observation.camera, pose, marker.world_from_marker), times,
      velocity.velocity);
  if (!columns) {
    considered.used = false;
    considered.columns = ErrorColumns::none(kFitsNothing);
    return considered;
  }
  considered.columns = *columns;
  const auto& by_marker = considered.columns.by_marker;
  Matrix8d covariance =
      noise_covariance(observation, known.noise_px[considered.camera]) +
      by_marker * map_.own_covariance(observation.map_index) * by_marker.transpose();
  // A motion that is not known moves rows that are not known to when they were read.
  const double row = mean_row(observation);
  const double row_variance = row * row * known.learnt.variances_of(considered.camera)[kReadout];
  covariance +=
      row_variance * (columns->by_pose * velocity.covariance * columns->by_pose.transpose());
  considered.columns.whiten(covariance);
  if (known.calibration.modes() > 0) {
    considered.by_modes.noalias() = by_marker * marker.modes.cast<double>();
  }
  return considered;
}

bool RobustPose::refine(std::span<SetObservation> observations, const VelocityPrior& velocity,
                        const KnownErrors& known, Rigid3& pose) {
  std::bitset<kMaxObservations> inliers;
  for (std::size_t i = 0; i < observations.size(); ++i) inliers[i] = observations[i].inlier;
  const Rigid3 start = pose;
  if (refine_by(observations, velocity, known, known.learnt, pose)) return true;
  // Calibrations may be other than was learnt since a moment ago.
  for (std::size_t i = 0; i < observations.size(); ++i) observations[i].inlier = inliers[i];
  pose = start;
  return refine_by(observations, velocity, known, known.calibration, pose);
}

bool RobustPose::refine_by(std::span<SetObservation> observations, const VelocityPrior& velocity,
                           const KnownErrors& known, const CalibrationPrior& calibration,
                           Rigid3& pose) {
  constexpr int kRounds = 6;
  constexpr double kLinear_m = 0.003;
  constexpr double kLinear_rad = 0.001;
  for (int round = 0; round < kRounds; ++round) {
    whitening_.move_to_set_instant(observations, pose, velocity.velocity);
    considered_.clear();
    int inliers = 0;
    for (const SetObservation& o : observations) {
      considered_.push_back(linearize(o, pose, velocity, known));
      inliers += considered_.back().used ? 1 : 0;
    }
    if (inliers == 0) return false;
    if (!consider_.solve(considered_, calibration, velocity.covariance)) return false;
    const Vector6d step = consider_.step();
    pose = pose.plus(step);
    const bool settled = tell_inliers(observations);
    if (settled && step.head<3>().norm() <= kLinear_m && step.tail<3>().norm() <= kLinear_rad) {
      return true;
    }
  }
  return std::any_of(observations.begin(), observations.end(),
                     [](const SetObservation& o) { return o.inlier; });
}

/// By what each leaves of the pose of the others. One that is grossly wrong makes others seem so:
/// those far behind the worst are judged when it is out. True: nothing has changed.
bool RobustPose::tell_inliers(std::span<SetObservation> observations) {
  constexpr double kFarBehind = 0.25;
  double worst = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    observations[i].sigmas_squared = consider_.squared_sigmas(i);
    if (observations[i].inlier) worst = std::max(worst, observations[i].sigmas_squared);
  }
  const double limit =
      std::max(options_.inlier_sigmas * options_.inlier_sigmas, kFarBehind * worst);
  bool settled = true;
  for (SetObservation& o : observations) {
    const bool inlier =
        o.sigmas_squared <= (o.inlier ? limit : options_.inlier_sigmas * options_.inlier_sigmas);
    settled = settled && inlier == o.inlier;
    o.inlier = inlier;
  }
  return settled;
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
                        const VelocityPrior& believed, const KnownErrors& known) {
  whitening_.move_to_set_instant(observations, pose, believed.velocity);
  whitening_.whiten(observations, pose, believed, known);
  collect(observations, Which::all);
  if (const auto tukey = solver_.refine(fixed_, pose, {Loss::tukey, options_.tukey_sigmas})) {
    pose = tukey->pose;
  }
  // Who is an inlier changes with the pose, hardly ever twice.
  int before = -1;
  for (int round = 0; round < 3; ++round) {
    whitening_.move_to_set_instant(observations, pose, believed.velocity);
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
                                      const VelocityPrior& believed, const KnownErrors& known) {
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
    if (!polish(observations, candidate, believed, known)) continue;
    collect(observations, Which::all);
    const double rank = solver_.rank(fixed_, candidate);
    if (rank >= best) continue;
    best = rank;
    pose = candidate;
  }
  return std::isfinite(best) && polish(observations, pose, believed, known);
}

/// When a quarter or more are outliers: what pose do they give among themselves? It is taken when
/// it explains more of all than the other did. True when both explain the set about as well.
bool RobustPose::try_pose_of_outliers(std::span<SetObservation> observations, Rigid3& pose,
                                      const VelocityPrior& believed, const KnownErrors& known) {
  constexpr double kAlike = 20.0;  // sigmas², as RigPoseOptions::ambiguity_gap
  collect(observations, Which::outliers);
  if (4 * fixed_.size() < observations.size() || fixed_.empty()) return false;
  const auto theirs = solver_.refine(fixed_, pose);
  if (!theirs) return false;
  collect(observations, Which::all);
  const double ours = solver_.rank(fixed_, pose);
  Rigid3 other = theirs->pose;
  const bool exists = polish(observations, other, believed, known);
  collect(observations, Which::all);
  const double gain = exists ? ours - solver_.rank(fixed_, other) : -2 * kAlike;
  if (gain > 0) {
    pose = other;
  } else if (!polish(observations, pose, believed, known)) {
    return true;
  }
  const bool distinct = angle_between_rad(other.rotation, pose.rotation) > 0.002 ||
                        (other.translation - pose.translation).norm() > 0.01;
  return exists && std::abs(gain) < kAlike && (gain > 0 || distinct);
}

void RobustPose::hold_against(std::span<SetObservation> observations, const PoseSolution& solution,
                              const KnownErrors& known) {
  whitening_.move_to_set_instant(observations, solution.world_from_rig, solution.velocity);
  whitening_.whiten(observations, solution.world_from_rig, {solution.velocity, Matrix6d::Zero()},
                    known);
  classify(observations, solution.world_from_rig);
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
