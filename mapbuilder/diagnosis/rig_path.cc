#include "mapbuilder/diagnosis/rig_path.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"

namespace waymark {
namespace {

/// A gap longer than so many periods says nothing of what happened in it.
constexpr double kLongestGap = 3.5;
/// A path is smooth where a set lies within this share of the step from where its neighbours, at
/// constant velocity, put it.
constexpr double kSmooth = 0.5;

Rigid3 interpolate(const Rigid3& a, const Rigid3& b, double share) {
  return a.plus(share * b.minus(a));
}

}  // namespace

RigPath::RigPath(const CameraTracks& tracks, const Extrinsics& rig_from_cam, double noise_scale,
                 int without) {
  std::vector<double> steps;
  for (const CameraTracks::Instant& instant : tracks.instants) {
    time_s_.push_back(
        std::chrono::duration<double>(instant.stamp - tracks.instants.front().stamp).count());
    world_from_rig_.push_back(agree(instant, rig_from_cam, noise_scale, without).world_from_rig);
    if (time_s_.size() > 1) steps.push_back(time_s_.back() - time_s_[time_s_.size() - 2]);
  }
  if (steps.empty()) return;
  period_s_ = upper_median(steps);
  std::size_t smooth = 0;
  std::size_t judged = 0;
  for (std::size_t i = 1; i + 1 < time_s_.size(); ++i) {
    if (!world_from_rig_[i - 1] || !world_from_rig_[i] || !world_from_rig_[i + 1]) continue;
    const Vector6d step = world_from_rig_[i + 1]->minus(*world_from_rig_[i - 1]);
    const double share = (time_s_[i] - time_s_[i - 1]) / (time_s_[i + 1] - time_s_[i - 1]);
    const Vector6d bend = world_from_rig_[i]->minus(
        interpolate(*world_from_rig_[i - 1], *world_from_rig_[i + 1], share));
    ++judged;
    smooth += bend.norm() <= kSmooth * step.norm() ? 1 : 0;
  }
  moves_ = judged >= 3 && 2 * smooth > judged;
}

std::optional<Rigid3> RigPath::motion(std::size_t instant, double offset_s) const {
  if (!world_from_rig_[instant]) return std::nullopt;
  const double when = time_s_[instant] + offset_s;
  auto after = static_cast<std::size_t>(std::upper_bound(time_s_.begin(), time_s_.end(), when) -
                                        time_s_.begin());
  after = std::clamp<std::size_t>(after, 1, time_s_.size() - 1);
  std::size_t before = after - 1;
  while (before > 0 && !world_from_rig_[before]) --before;
  while (after + 1 < time_s_.size() && !world_from_rig_[after]) ++after;
  if (!world_from_rig_[before] || !world_from_rig_[after]) return std::nullopt;
  const double gap = time_s_[after] - time_s_[before];
  if (gap <= 0 || gap > kLongestGap * period_s_) return std::nullopt;
  const double share = (when - time_s_[before]) / gap;
  if (share < -1.5 || share > 2.5) return std::nullopt;  // beyond the ends: too far to extrapolate
  const Rigid3 then = interpolate(*world_from_rig_[before], *world_from_rig_[after], share);
  return then * world_from_rig_[instant]->inverse();
}

}  // namespace waymark
