#include "locd/camera_watch.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace waymark {
namespace {

constexpr double kMeanMemory = 0.95;
constexpr double kTrustedShare = 0.7;
constexpr double kFits = 36.0;

RigPoseOptions solver_options() {
  RigPoseOptions options;
  options.bounded_score_sigmas = 10.0;
  options.max_seed_observations = 8;
  options.max_refined = 2;
  options.max_iterations = 15;
  return options;
}

}  // namespace

CameraWatch::CameraWatch(const Rig& rig, const MapIndex& map, const CameraWatchOptions& options)
    : map_(map),
      options_(options),
      cameras_(rig.cameras.size()),
      solver_(rig, solver_options()),
      swap_sets_(cameras_ * cameras_, 0) {
  scratch_.reserve(kMaxObservations);
  fixed_.reserve(kMaxObservations);
}

void CameraWatch::update(Stamp stamp, std::span<const SetObservation> observations,
                         std::vector<Alert>& alerts) {
  sights_.fill({});
  for (const SetObservation& o : observations) {
    Sight& sight = sights_[static_cast<std::size_t>(o.observation.camera)];
    ++sight.markers;
    sight.inliers += o.inlier ? 1 : 0;
  }
  int seeing = 0;
  bool all_coherent = true;
  for (std::size_t c = 0; c < cameras_; ++c) {
    const Sight& sight = sights_[c];
    if (sight.markers == 0) continue;
    const double share = static_cast<double>(sight.inliers) / sight.markers;
    records_[c].inlier_share = kMeanMemory * records_[c].inlier_share + (1 - kMeanMemory) * share;
    seeing += sight.markers >= 2 ? 1 : 0;
    if (sight.markers >= 2 && 2 * sight.inliers < sight.markers) all_coherent = false;
  }
  if (seeing < 2) return;
  if (all_coherent) {
    for (std::size_t c = 0; c < cameras_; ++c) {
      if (sights_[c].markers < 2) continue;
      Record& record = records_[c];
      record.sets_fine = std::min(record.sets_fine + 1, 10);
      record.sets_off = std::max(record.sets_off - 1, 0);
      if (record.named && record.sets_fine >= 10) clear(stamp, c, alerts);
    }
    for (int& sets : swap_sets_) sets = std::max(sets - 1, 0);
    return;
  }
  // One question per set: enough within 200 of them, and no set takes much longer than others.
  const std::size_t pairs = cameras_ * (cameras_ - 1) / 2;
  for (std::size_t tried = 0; tried < cameras_ + pairs; ++tried) {
    const std::size_t question = turn_++ % (cameras_ + pairs);
    if (question < cameras_) {
      if (sights_[question].markers < 2) continue;
      hold_against_others(stamp, question, observations, alerts);
      return;
    }
    std::size_t pair = question - cameras_;
    std::size_t a = 0;
    while (pair >= cameras_ - 1 - a) pair -= cameras_ - 1 - a++;
    const std::size_t b = a + 1 + pair;
    if (sights_[a].markers == 0 || sights_[b].markers == 0) continue;
    try_swap(stamp, a, b, observations, alerts);
    return;
  }
}

void CameraWatch::hold_against_others(Stamp stamp, std::size_t camera,
                                      std::span<const SetObservation> observations,
                                      std::vector<Alert>& alerts) {
  const auto alone = view_by(observations, camera_bit(camera), 0, 0);
  const auto others = view_by(observations, ~camera_bit(camera), 0, 0);
  if (!alone || !others || !coherent(*alone) || !coherent(*others)) return;
  // Both as the rig in the world: what lies between them is the camera's own.
  const Vector6d apart = alone->optimum.pose.minus(others->optimum.pose);
  const Matrix6d covariance = alone->optimum.covariance + others->optimum.covariance;
  const bool large = apart.tail<3>().norm() >= options_.min_turn_rad ||
                     apart.head<3>().norm() >= options_.min_offset_m;
  Record& record = records_[camera];
  if (!large || apart.dot(covariance.ldlt().solve(apart)) < options_.chi2) {
    record.sets_fine = std::min(record.sets_fine + 1, 10);
    return;
  }
  ++record.sets_off;
  if (record.named || record.sets_off < options_.sets_to_name ||
      record.sets_off < 9 * record.sets_fine) {
    return;
  }
  name(stamp, AlertKind::extrinsics_off, static_cast<int>(camera), -1, apart, alerts);
}

void CameraWatch::try_swap(Stamp stamp, std::size_t a, std::size_t b,
                           std::span<const SetObservation> observations,
                           std::vector<Alert>& alerts) {
  constexpr CameraMask kAll = ~CameraMask{0};
  const auto as_is = view_by(observations, kAll, 0, 0);
  const auto swapped = view_by(observations, kAll, a, b);
  if (!swapped || !coherent(*swapped) || (as_is && coherent(*as_is))) return;
  int& sets = swap_sets_[a * cameras_ + b];
  if (++sets == options_.sets_to_name / 2 && !records_[a].named) {
    name(stamp, AlertKind::cameras_swapped, static_cast<int>(a), static_cast<int>(b),
         Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()), alerts);
  }
}

std::optional<CameraWatch::View> CameraWatch::view_by(std::span<const SetObservation> observations,
                                                      CameraMask cameras, std::size_t swap_a,
                                                      std::size_t swap_b) {
  scratch_.clear();
  fixed_.clear();
  for (const SetObservation& o : observations) {
    auto camera = static_cast<std::size_t>(o.observation.camera);
    if ((cameras & camera_bit(camera)) == 0) continue;
    if (camera == swap_a) {
      camera = swap_b;
    } else if (camera == swap_b) {
      camera = swap_a;
    }
    MarkerObservation& own = scratch_.emplace_back(o.observation);
    own.camera = static_cast<int>(camera);
    own.ippe = solve_ippe(solver_.model(camera), own.corners_px, own.size_m);
    fixed_.push_back({&own, map_.marker(o.map_index).world_from_marker});
  }
  if (fixed_.size() < 2) return std::nullopt;
  const auto estimate = solver_.solve(fixed_);
  if (!estimate || estimate->ambiguous) return std::nullopt;
  View view{estimate->best, static_cast<int>(fixed_.size()), 0};
  const Rigid3 rig_from_world = view.optimum.pose.inverse();
  for (const FixedMarkerObservation& fixed : fixed_) {
    const auto camera = static_cast<std::size_t>(fixed.observation->camera);
    const double s =
        squared_residual(*fixed.observation, solver_.model(camera),
                         solver_.cam_from_rig(camera) * (rig_from_world * fixed.world_from_marker));
    view.inliers += s <= kFits ? 1 : 0;
  }
  return view;
}

bool CameraWatch::coherent(const View& view) const {
  return view.inliers >= 2 && view.inliers >= options_.coherent_share * view.observations;
}

void CameraWatch::name(Stamp stamp, AlertKind kind, int camera, int other, const Vector6d& offset,
                       std::vector<Alert>& alerts) {
  Alert alert;
  alert.kind = kind;
  alert.stamp = stamp;
  alert.camera = camera;
  alert.other_camera = other;
  alert.offset_m = offset.head<3>().norm();
  alert.offset_rad = offset.tail<3>().norm();
  alerts.push_back(alert);
  // What spoke against others was said of this one.
  for (Record& record : records_) record.sets_off = 0;
  for (const int one : {camera, other}) {
    if (one < 0) continue;
    Record& record = records_[static_cast<std::size_t>(one)];
    record.named = true;
    record.kind = kind;
    record.sets_fine = 0;
  }
}

void CameraWatch::clear(Stamp stamp, std::size_t camera, std::vector<Alert>& alerts) {
  records_[camera].named = false;
  Alert alert;
  alert.kind = records_[camera].kind;
  alert.raised = false;
  alert.stamp = stamp;
  alert.camera = static_cast<int>(camera);
  alerts.push_back(alert);
}

CameraMask CameraWatch::trusted() const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (records_[c].inlier_share >= kTrustedShare && !records_[c].named) mask |= camera_bit(c);
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
