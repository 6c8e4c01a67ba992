#include "locd/pose/camera_watch.h"

#include <algorithm>
#include <limits>

#include "core/base/check.h"
#include "core/base/median.h"
#include "core/estimate/robust_loss.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

constexpr double kMeanMemory = 0.95;
/// Share of a marker's misfit that a displacement which explains it may leave: it is linear only.
constexpr double kLeftOver = 0.02;
/// χ² that one set may have against a camera: a third of what names it.
constexpr double kMostPerSet = 25.0;
constexpr double kTukeySigmas = 8.0;
constexpr int kOwnRounds = 4;
constexpr std::size_t kFewest = 3;  // observations that can tell of a swap
constexpr double kLinear_m = 0.3;
constexpr double kLinear_rad = 0.1;

RigPoseOptions solver_options() {
  RigPoseOptions options;
  options.bounded_score_sigmas = 10.0;
  options.max_seed_observations = 6;
  options.max_refined = 2;
  options.max_iterations = 15;
  return options;
}

double squared_sigmas(const Eigen::Vector3d& offset, const Eigen::Matrix3d& covariance) {
  return offset.dot(SymmetricFactor<3>(covariance).solve(offset));
}

}  // namespace

Status CameraWatchOptions::check() const {
  return RangeCheck()
      .field("min_turn_rad", min_turn_rad, {0.001, 0.2})
      .field("min_offset_m", min_offset_m, {0.001, 1})
      .field("chi2", chi2, {20, 1000})
      .field("memory_sets", memory_sets, {10, 1000})
      .field("min_sets", min_sets, {3, 1000})
      .field("clear_margin", clear_margin, {1, 10})
      .field("sets_to_decide", sets_to_decide, {static_cast<double>(min_sets), 10'000})
      .field("trusted_share", trusted_share, {0.5, 1})
      .field("swap_sets", swap_sets, {2, 1000})
      .field("right_sets", right_sets, {2, 1000})
      .field("coherent_share", coherent_share, {0.5, 1})
      .status();
}

CameraWatch::CameraWatch(const Rig& rig, const MapIndex& map, const CameraWatchOptions& options)
    : map_(map), options_(options), cameras_(rig.cameras.size()), solver_(rig, solver_options()) {
  WAYMARK_CHECK(options.check().has_value());
  for (std::size_t a = 0; a < cameras_; ++a) {
    for (std::size_t b = a + 1; b < cameras_; ++b) pairs_.push_back({a, b, 0});
  }
  whitened_.reserve(kMaxObservations);
  squared_.reserve(kMaxObservations);
  scratch_.reserve(kMaxObservations);
  fixed_.reserve(kMaxObservations);
}

void CameraWatch::update(Stamp stamp, std::span<const SetObservation> observations,
                         const Rigid3& world_from_rig, std::vector<Alert>& alerts) {
  own_count_ = 0;
  int seeing = 0;
  int pairs_of_markers = 0;
  int inliers = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    fit_camera(c, observations, world_from_rig);
    const OwnFit& fit = fits_[c];
    if (fit.markers == 0) continue;
    const double share = static_cast<double>(fit.inliers) / fit.markers;
    double& mean = records_[c].inlier_share;
    mean = kMeanMemory * mean + (1 - kMeanMemory) * share;
    ++seeing;
    pairs_of_markers += fit.markers >= 2 ? 1 : 0;
    inliers += fit.inliers;
  }
  if (seeing < 2) return;
  sum_displacements();
  judge_displacements(stamp, alerts);
  if (observations.size() < kFewest) return;
  const bool coherent =
      inliers >= options_.coherent_share * static_cast<double>(observations.size());
  look_for_swaps_that_ended(stamp, coherent, alerts);
  if (!coherent) {
    look_for_swap(stamp, observations, alerts);
  } else if (pairs_of_markers >= 2) {
    for (CameraPair& pair : pairs_) pair.sets = std::max(pair.sets - 1, 0);
  }
}

/// Fits a small displacement of the rig, in its own axes, to one camera's markers alone.
void CameraWatch::fit_camera(std::size_t camera, std::span<const SetObservation> observations,
                             const Rigid3& world_from_rig) {
  OwnFit& fit = fits_[camera];
  fit = {};
  whitened_.clear();
  const Eigen::Matrix3d world_from_rig_axes = world_from_rig.rotation.toRotationMatrix();
  for (const SetObservation& o : observations) {
    if (static_cast<std::size_t>(o.observation.camera) != camera) continue;
    ++fit.markers;
    fit.inliers += o.inlier ? 1 : 0;
    auto whitened = whitened_residual(o, map_, solver_, world_from_rig);
    if (!whitened) continue;
    whitened->by_rig.leftCols<3>() *= world_from_rig_axes;
    whitened->by_rig.rightCols<3>() *= world_from_rig_axes;
    whitened_.push_back(*whitened);
  }
  if (whitened_.size() < 2) return;
  Vector6d step = Vector6d::Zero();
  for (int round = 0; round < kOwnRounds; ++round) {
    // At first every marker counts, whatever its distance; then those that agree.
    squared_.clear();
    for (const WhitenedResidual& w : whitened_) {
      squared_.push_back((w.residual + w.by_rig * step).squaredNorm());
    }
    const double scale2 = kTukeySigmas * kTukeySigmas * std::max(1.0, median(squared_) / 8.0);
    fit.information.setZero();
    fit.evidence.setZero();
    for (const WhitenedResidual& w : whitened_) {
      const double s = (w.residual + w.by_rig * step).squaredNorm();
      const double weight = round == 0 ? 1.0 / std::max(1.0, std::sqrt(s))
                                       : robust_weight(Loss::tukey, std::sqrt(scale2), s);
      fit.information.noalias() += weight * w.by_rig.transpose() * w.by_rig;
      fit.evidence.noalias() -= weight * w.by_rig.transpose() * w.residual;
    }
    fit.information.diagonal().array() += 1e-9;
    step = SymmetricFactor<6>(fit.information).solve(fit.evidence);
  }
  squared_.clear();
  std::size_t explained = 0;
  for (const WhitenedResidual& w : whitened_) {
    const double left = (w.residual + w.by_rig * step).squaredNorm();
    squared_.push_back(left);
    explained += left <= std::max(kInlierSigmas2, kLeftOver * w.residual.squaredNorm()) ? 1 : 0;
  }
  // A camera that stands elsewhere has all its markers elsewhere; one that sees a moved marker has
  // not. Farther off nothing is linear; swapped cameras are looked for in another way.
  fit.summable = static_cast<double>(explained) >=
                     options_.coherent_share * static_cast<double>(whitened_.size()) &&
                 step.head<3>().norm() < kLinear_m && step.tail<3>().norm() < kLinear_rad;
  own_residuals_[own_count_++] = {median(squared_), static_cast<int>(squared_.size())};
}

/// The set's pose eliminated: what is left speaks of one camera against the others.
void CameraWatch::sum_displacements() {
  Matrix6d all = Matrix6d::Zero();
  Vector6d evidence = Vector6d::Zero();
  int summable = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (!fits_[c].summable) continue;
    ++summable;
    all += fits_[c].information;
    evidence += fits_[c].evidence;
  }
  if (summable < 2) return;
  const SymmetricFactor<6> factor(all);
  const Vector6d common = factor.solve(evidence);
  const double keep = 1.0 - 1.0 / options_.memory_sets;
  for (std::size_t c = 0; c < cameras_; ++c) {
    const OwnFit& fit = fits_[c];
    Record& record = records_[c];
    record.information *= keep;
    record.evidence *= keep;
    if (!fit.summable) continue;
    const Matrix6d information =
        fit.information - fit.information * factor.solve_columns(fit.information);
    const Vector6d against = fit.evidence - fit.information * common;
    // No set alone may condemn a camera: it may show two markers that were moved, and no other.
    const Vector6d offset = SymmetricFactor<6>(information + Matrix6d::Identity()).solve(against);
    const double say = std::min(1.0, kMostPerSet / std::max(offset.dot(against), kMostPerSet));
    record.information += say * information;
    record.evidence += say * against;
    ++record.sets;
  }
}

CameraWatch::Displacement CameraWatch::displacement(const Record& record) const {
  Displacement result;
  // ± 1 m, ± 1 rad before anything was seen.
  const Matrix6d information = record.information + Matrix6d::Identity();
  const SymmetricFactor<6> factor(information);
  result.offset = factor.solve(record.evidence);
  result.explained = result.offset.dot(record.evidence);
  const Matrix6d covariance = factor.inverse();
  const double moved_m = result.offset.head<3>().norm();
  const double turned_rad = result.offset.tail<3>().norm();
  result.significant =
      (turned_rad >= options_.min_turn_rad &&
       squared_sigmas(result.offset.tail<3>(), covariance.bottomRightCorner<3, 3>()) >=
           options_.chi2) ||
      (moved_m >= options_.min_offset_m &&
       squared_sigmas(result.offset.head<3>(), covariance.topLeftCorner<3, 3>()) >= options_.chi2);
  result.small = turned_rad < 0.5 * options_.min_turn_rad && moved_m < 0.5 * options_.min_offset_m;
  return result;
}

void CameraWatch::judge_displacements(Stamp stamp, std::vector<Alert>& alerts) {
  std::size_t best = 0;
  Displacement most;
  double second = 0;
  bool known = false;
  int seen = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    Record& record = records_[c];
    if (record.sets == 0) continue;
    const Displacement d = displacement(record);
    if (record.named && record.kind == AlertKind::extrinsics_off && d.small) {
      end_verdict(stamp, c, alerts);
    }
    known = known || record.named;
    if (d.explained <= most.explained) {
      second = std::max(second, d.explained);
      continue;
    }
    second = most.explained;
    most = d;
    best = c;
    seen = record.sets;
  }
  // One fault is named at a time: it shows in all that are compared with it.
  if (known || !most.significant || seen < options_.min_sets) return;
  // Two cameras that only ever see each other stay undecided: then the one is as good as the other.
  if (most.explained < options_.clear_margin * second && seen < options_.sets_to_decide) return;
  raise(stamp, AlertKind::extrinsics_off, best, -1, most.offset, alerts);
}

/// A camera in another's place agrees with no other camera; one whose markers are inliers together
/// with those of another one stands where it should.
void CameraWatch::look_for_swaps_that_ended(Stamp stamp, bool coherent,
                                            std::vector<Alert>& alerts) {
  CameraMask agreeing = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    const OwnFit& fit = fits_[c];
    const bool fits = fit.inliers >= 2 && fit.inliers >= options_.coherent_share * fit.markers;
    if (coherent && fits) agreeing |= camera_bit(c);
  }
  for (std::size_t c = 0; c < cameras_; ++c) {
    Record& record = records_[c];
    if (!record.named || record.kind != AlertKind::cameras_swapped) continue;
    if (fits_[c].markers < 2) continue;
    const bool agrees = (agreeing & camera_bit(c)) != 0 && agreeing != camera_bit(c);
    record.right_sets = agrees ? record.right_sets + 1 : 0;
  }
  for (std::size_t c = 0; c < cameras_; ++c) {
    const Record& record = records_[c];
    if (!record.named || record.kind != AlertKind::cameras_swapped) continue;
    if (std::min(record.right_sets, records_[record.partner].right_sets) >= options_.right_sets) {
      end_verdict(stamp, c, alerts);
    }
  }
}

/// Whether both see something and neither was named as swapped.
bool CameraWatch::may_be_swapped(const CameraPair& pair) const {
  for (const std::size_t camera : {pair.a, pair.b}) {
    const Record& record = records_[camera];
    if (record.named && record.kind == AlertKind::cameras_swapped) return false;
    if (fits_[camera].markers == 0) return false;
  }
  return true;
}

/// One pair per set, so that no set takes much longer than others; who explains a set is asked
/// again at the next.
void CameraWatch::look_for_swap(Stamp stamp, std::span<const SetObservation> observations,
                                std::vector<Alert>& alerts) {
  std::size_t passed_over = 0;
  while (!may_be_swapped(pairs_[asked_pair_])) {
    if (++passed_over == pairs_.size()) return;
    asked_pair_ = (asked_pair_ + 1) % pairs_.size();
  }
  CameraPair& pair = pairs_[asked_pair_];
  if (!coherent_when_swapped(observations, pair.a, pair.b)) {
    asked_pair_ = (asked_pair_ + 1) % pairs_.size();
    return;
  }
  if (++pair.sets < options_.swap_sets) return;
  pair.sets = 0;
  // The swap explains it.
  for (const std::size_t camera : {pair.a, pair.b}) {
    if (records_[camera].named) end_verdict(stamp, camera, alerts);
  }
  raise(stamp, AlertKind::cameras_swapped, pair.a, static_cast<int>(pair.b),
        Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()), alerts);
}

bool CameraWatch::coherent_when_swapped(std::span<const SetObservation> observations, std::size_t a,
                                        std::size_t b) {
  scratch_.clear();
  fixed_.clear();
  for (const SetObservation& o : observations) {
    MarkerObservation& own = scratch_.emplace_back(o.observation);
    const auto camera = static_cast<std::size_t>(own.camera);
    own.camera = static_cast<int>(camera == a ? b : camera == b ? a : camera);
    own.ippe =
        solve_ippe(solver_.model(static_cast<std::size_t>(own.camera)), own.corners_px, own.size_m);
    fixed_.push_back({&own, map_.marker(o.map_index).world_from_marker});
  }
  const auto estimate = solver_.solve(fixed_);
  if (!estimate || estimate->ambiguous) return false;
  const Rigid3 rig_from_world = estimate->best.pose.inverse();
  int inliers = 0;
  for (const FixedMarkerObservation& fixed : fixed_) {
    const auto camera = static_cast<std::size_t>(fixed.observation->camera);
    const double s =
        squared_residual(*fixed.observation, solver_.model(camera),
                         solver_.cam_from_rig(camera) * (rig_from_world * fixed.world_from_marker));
    inliers += s <= kInlierSigmas2 ? 1 : 0;
  }
  return inliers >= options_.coherent_share * static_cast<double>(fixed_.size());
}

void CameraWatch::raise(Stamp stamp, AlertKind kind, std::size_t camera, int other,
                        const Vector6d& offset, std::vector<Alert>& alerts) {
  Alert alert;
  alert.kind = kind;
  alert.stamp = stamp;
  alert.camera = static_cast<int>(camera);
  alert.other_camera = other;
  alert.offset_m = offset.head<3>().norm();
  alert.offset_rad = offset.tail<3>().norm();
  alerts.push_back(alert);
  records_[camera].named = true;
  records_[camera].kind = kind;
  if (other < 0) return;
  const auto partner = static_cast<std::size_t>(other);
  for (const std::size_t one : {camera, partner}) {
    records_[one].named = true;
    records_[one].kind = kind;
    records_[one].partner = one == camera ? partner : camera;
    records_[one].right_sets = 0;
  }
}

/// What was summed while the verdict stood told of the fault; it is begun anew.
void CameraWatch::end_verdict(Stamp stamp, std::size_t camera, std::vector<Alert>& alerts) {
  Alert alert;
  alert.kind = records_[camera].kind;
  alert.raised = false;
  alert.stamp = stamp;
  alert.camera = static_cast<int>(camera);
  if (alert.kind == AlertKind::cameras_swapped) {
    const std::size_t partner = records_[camera].partner;
    alert.other_camera = static_cast<int>(partner);
    for (Record& record : records_) {
      record.information.setZero();
      record.evidence.setZero();
      record.sets = 0;
    }
    records_[partner].named = false;
  }
  records_[camera].named = false;
  alerts.push_back(alert);
}

CameraMask CameraWatch::trusted() const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (records_[c].inlier_share >= options_.trusted_share && !records_[c].named) {
      mask |= camera_bit(c);
    }
  }
  return mask;
}

CameraMask CameraWatch::suspects() const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (records_[c].named) mask |= camera_bit(c);
  }
  return mask;
}

}  // namespace waymark
