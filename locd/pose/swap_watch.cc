#include "locd/pose/swap_watch.h"

#include <algorithm>

#include "core/base/check.h"

namespace waymark {
namespace {

constexpr double kMeanMemory = 0.95;
constexpr std::size_t kFewest = 3;  // observations that can tell of a swap

RigPoseOptions solver_options() {
  RigPoseOptions options;
  options.give_up_beside_known = true;
  options.bounded_score_sigmas = 10.0;
  options.max_seed_observations = 6;
  options.max_refined = 2;
  options.max_iterations = 15;
  return options;
}

}  // namespace

Status SwapWatchOptions::check() const {
  return RangeCheck()
      .field("trusted_share", trusted_share, {0.5, 1})
      .field("swap_sets", swap_sets, {2, 1000})
      .field("right_sets", right_sets, {2, 1000})
      .field("coherent_share", coherent_share, {0.5, 1})
      .status();
}

SwapWatch::SwapWatch(const Rig& rig, const MapIndex& map, const SwapWatchOptions& options)
    : map_(map), options_(options), cameras_(rig.cameras.size()), solver_(rig, solver_options()) {
  WAYMARK_CHECK(options.check().has_value());
  for (std::size_t a = 0; a < cameras_; ++a) {
    for (std::size_t b = a + 1; b < cameras_; ++b) pairs_.push_back({a, b, 0, std::nullopt});
  }
  scratch_.reserve(kMaxObservations);
  fixed_.reserve(kMaxObservations);
  solver_.reserve(kMaxObservations);
}

void SwapWatch::update(Stamp stamp, const Rigid3& world_from_rig,
                       std::span<const SetObservation> observations, std::vector<Alert>& alerts) {
  for (Record& record : records_) record.markers = record.inliers = 0;
  for (const SetObservation& o : observations) {
    Record& record = records_[static_cast<std::size_t>(o.observation.camera)];
    ++record.markers;
    record.inliers += o.inlier ? 1 : 0;
  }
  int seeing = 0;
  int pairs_of_markers = 0;
  int inliers = 0;
  for (Record& record : records_) {
    if (record.markers == 0) continue;
    const double share = static_cast<double>(record.inliers) / record.markers;
    record.inlier_share = kMeanMemory * record.inlier_share + (1 - kMeanMemory) * share;
    ++seeing;
    pairs_of_markers += record.markers >= 2 ? 1 : 0;
    inliers += record.inliers;
  }
  if (seeing < 2 || observations.size() < kFewest) return;
  const bool coherent =
      inliers >= options_.coherent_share * static_cast<double>(observations.size());
  look_for_swaps_that_ended(stamp, coherent, alerts);
  if (!coherent) {
    look_for_swap(stamp, observations, alerts);
  } else if (pairs_of_markers >= 2) {
    last_coherent_ = {stamp, world_from_rig.rotation};
    for (CameraPair& pair : pairs_) {
      pair.sets = std::max(pair.sets - 1, 0);
      pair.last.reset();
    }
  }
}

/// A camera in another's place agrees with no other camera; one whose markers are inliers together
/// with those of another one stands where it should.
void SwapWatch::look_for_swaps_that_ended(Stamp stamp, bool coherent, std::vector<Alert>& alerts) {
  CameraMask agreeing = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    const Record& record = records_[c];
    const bool fits =
        record.inliers >= 2 && record.inliers >= options_.coherent_share * record.markers;
    if (coherent && fits) agreeing |= camera_bit(c);
  }
  for (std::size_t c = 0; c < cameras_; ++c) {
    Record& record = records_[c];
    if (!record.named) continue;
    if (records_[c].markers < 2) continue;
    const bool agrees = (agreeing & camera_bit(c)) != 0 && agreeing != camera_bit(c);
    record.right_sets = agrees ? record.right_sets + 1 : 0;
  }
  for (std::size_t c = 0; c < cameras_; ++c) {
    const Record& record = records_[c];
    if (!record.named) continue;
    if (std::min(record.right_sets, records_[record.partner].right_sets) >= options_.right_sets) {
      tell(stamp, c, false, alerts);
    }
  }
}

/// Whether both see something and neither was named as swapped.
bool SwapWatch::may_be_swapped(const CameraPair& pair) const {
  for (const std::size_t camera : {pair.a, pair.b}) {
    const Record& record = records_[camera];
    if (record.named) return false;
    if (record.markers == 0) return false;
  }
  return true;
}

/// One pair per set, so that no set takes much longer than others; who explains a set is asked
/// again at the next.
void SwapWatch::look_for_swap(Stamp stamp, std::span<const SetObservation> observations,
                              std::vector<Alert>& alerts) {
  std::size_t passed_over = 0;
  while (!may_be_swapped(pairs_[asked_pair_])) {
    if (++passed_over == pairs_.size()) return;
    asked_pair_ = (asked_pair_ + 1) % pairs_.size();
  }
  CameraPair& pair = pairs_[asked_pair_];
  const auto rotation = explained_by_swap(observations, pair.a, pair.b);
  if (!rotation || !can_have_turned(pair, {stamp, *rotation})) {
    asked_pair_ = (asked_pair_ + 1) % pairs_.size();
    return;
  }
  pair.last = {stamp, *rotation};
  if (++pair.sets < options_.swap_sets) return;
  pair.sets = 0;
  records_[pair.a].partner = pair.b;
  records_[pair.b].partner = pair.a;
  tell(stamp, pair.a, true, alerts);
}

/// In a ring of cameras one swap looks like another one, seen from a rig that is turned by a
/// camera's place: a rig that was known a moment ago can't have turned so far.
bool SwapWatch::can_have_turned(const CameraPair& pair, const Turned& now) const {
  constexpr double kAtOnce_rad = 0.35;
  constexpr double kFastest_radps = 2.1;
  constexpr double kRemembered_s = 0.8;  // then it may have turned by a third of a circle
  const std::optional<Turned>& before = pair.last ? pair.last : last_coherent_;
  if (!before) return true;
  const double elapsed_s = in_s(now.stamp - before->stamp);
  if (elapsed_s > kRemembered_s) return true;
  return angle_between_rad(before->world_from_rig, now.world_from_rig) <=
         kAtOnce_rad + kFastest_radps * elapsed_s;
}

std::optional<Eigen::Quaterniond> SwapWatch::explained_by_swap(
    std::span<const SetObservation> observations, std::size_t a, std::size_t b) {
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
  if (!estimate || estimate->ambiguous) return std::nullopt;
  const Rigid3 rig_from_world = estimate->best.pose.inverse();
  int inliers = 0;
  for (const FixedMarkerObservation& fixed : fixed_) {
    const auto camera = static_cast<std::size_t>(fixed.observation->camera);
    const double s =
        squared_residual(*fixed.observation, solver_.model(camera),
                         solver_.cam_from_rig(camera) * (rig_from_world * fixed.world_from_marker));
    inliers += s <= kInlierSigmas2 ? 1 : 0;
  }
  if (inliers < options_.coherent_share * static_cast<double>(fixed_.size())) return std::nullopt;
  return estimate->best.pose.rotation;
}

void SwapWatch::tell(Stamp stamp, std::size_t camera, bool raised, std::vector<Alert>& alerts) {
  const std::size_t partner = records_[camera].partner;
  for (const std::size_t one : {camera, partner}) {
    records_[one].named = raised;
    records_[one].right_sets = 0;
  }
  Alert alert;
  alert.kind = AlertKind::cameras_swapped;
  alert.raised = raised;
  alert.stamp = stamp;
  alert.camera = static_cast<int>(camera);
  alert.other_camera = static_cast<int>(partner);
  alerts.push_back(alert);
}

CameraMask SwapWatch::trusted() const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (records_[c].inlier_share >= options_.trusted_share && !records_[c].named) {
      mask |= camera_bit(c);
    }
  }
  return mask;
}

CameraMask SwapWatch::suspects() const {
  CameraMask mask = 0;
  for (std::size_t c = 0; c < cameras_; ++c) {
    if (records_[c].named) mask |= camera_bit(c);
  }
  return mask;
}

}  // namespace waymark
