#include "locd/pose/riding_watch.h"

#include <algorithm>

#include "core/estimate/ippe.h"

namespace waymark {
namespace {

/// A marker not seen for so many sets is looked at anew.
constexpr long kForgotten = 20;
/// Observations that are looked at in one set, by turns.
constexpr std::size_t kMost = 24;

}  // namespace

RidingWatch::RidingWatch(const MapIndex& map, const RigPoseSolver& solver)
    : map_(map), solver_(solver), records_(map.size()) {
  riding_.reserve(kMost);
}

std::span<const std::size_t> RidingWatch::look(std::span<const SetObservation> observations) {
  riding_.clear();
  ++sets_;
  const std::size_t count = observations.size();
  const std::size_t first = count > kMost ? static_cast<std::size_t>(sets_) * kMost % count : 0;
  for (std::size_t i = 0; i < std::min(count, kMost); ++i) {
    look_at(observations[(first + i) % count]);
  }
  return riding_;
}

void RidingWatch::look_at(const SetObservation& o) {
  Record& record = records_[o.map_index];
  if (record.since >= 0 && record.last == sets_) return;  // by another camera, in this set
  const auto camera = static_cast<std::size_t>(o.observation.camera);
  const auto ippe = solve_ippe(solver_.model(camera), o.detected_px, o.observation.size_m);
  if (!ippe) return;
  const Eigen::Vector3d& in_cam = ippe->cam_from_marker[0].translation;
  if (in_cam.norm() > kFarthest_m) return;
  const Eigen::Vector3d in_rig = solver_.cam_from_rig(camera).inverse() * in_cam;
  const bool anew = record.since < 0 || sets_ - record.last > kForgotten;
  record.last = sets_;
  const double moved_m = (in_rig - record.at_in_rig).norm();
  if (anew || moved_m > kPassed_m) {
    if (!anew) {
      passed_[next_passed_] = {o.map_index, record.since};
      next_passed_ = (next_passed_ + 1) % passed_.size();
    }
    record = {in_rig, sets_, sets_, 0, false};
    return;
  }
  if (moved_m > kStill_m + kStillShare * in_cam.norm()) {
    record.still = 0;
    return;
  }
  ++record.still;
  if (record.told || record.still < kStillSets || passed_since(record.since) < kPassing) return;
  record.told = true;
  riding_.push_back(o.map_index);
}

/// Different markers that passed by, beginning at that set or later.
int RidingWatch::passed_since(long set) const {
  int different = 0;
  for (std::size_t i = 0; i < passed_.size(); ++i) {
    if (passed_[i].since < set) continue;
    const bool before = std::any_of(
        passed_.begin(), passed_.begin() + static_cast<std::ptrdiff_t>(i),
        [&](const Passed& p) { return p.since >= set && p.map_index == passed_[i].map_index; });
    different += before ? 0 : 1;
  }
  return different;
}

}  // namespace waymark
