#include "mapbuilder/diagnosis/rig_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Hermite's cubic from 0 to `step` with these slopes at its ends.
Vector6d cubic_step(double share, const Vector6d& step, const Vector6d& leaving,
                    const Vector6d& arriving) {
  const double s2 = share * share;
  const double s3 = s2 * share;
  return (s3 - 2 * s2 + share) * leaving + (3 * s2 - 2 * s3) * step + (s3 - s2) * arriving;
}

double cubed(double x) { return x * x * x; }

}  // namespace

RigPath::RigPath(const CameraTracks& tracks, const Extrinsics& rig_from_cam, double noise_scale,
                 int without) {
  std::vector<double> steps;
  for (const CameraTracks::Instant& instant : tracks.instants) {
    time_s_.push_back(in_s(instant.stamp - tracks.instants.front().stamp));
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
  measure_wander();
}

double RigPath::gap_s(std::size_t before, std::size_t after) const {
  return time_s_[after] - time_s_[before];
}

std::optional<std::size_t> RigPath::neighbour(std::size_t instant, int step) const {
  for (auto i = static_cast<std::ptrdiff_t>(instant) + step;
       i >= 0 && i < static_cast<std::ptrdiff_t>(time_s_.size()); i += step) {
    const auto there = static_cast<std::size_t>(i);
    if (!world_from_rig_[there]) continue;
    if (std::abs(gap_s(instant, there)) > kLongestGap * period_s_) return std::nullopt;
    return there;
  }
  return std::nullopt;
}

Vector6d RigPath::velocity(std::size_t instant) const {
  const auto before = neighbour(instant, -1);
  const auto after = neighbour(instant, 1);
  const Rigid3& here = *world_from_rig_[instant];
  Vector6d arriving = Vector6d::Zero();
  Vector6d leaving = Vector6d::Zero();
  if (before) arriving = here.minus(*world_from_rig_[*before]) / gap_s(*before, instant);
  if (after) leaving = world_from_rig_[*after]->minus(here) / gap_s(instant, *after);
  if (!before || !after) return arriving + leaving;
  // The parabola through the three: the nearer neighbour tells more.
  const double share = gap_s(instant, *after) / gap_s(*before, *after);
  return share * arriving + (1.0 - share) * leaving;
}

Rigid3 RigPath::between(std::size_t before, std::size_t after, double share) const {
  const Rigid3& start = *world_from_rig_[before];
  const Vector6d step = world_from_rig_[after]->minus(start);
  if (share < 0 || share > 1) return start.plus(share * step);
  const double gap = gap_s(before, after);
  return start.plus(cubic_step(share, step, gap * velocity(before), gap * velocity(after)));
}

std::optional<RigPath::Span> RigPath::span_of(double when_s) const {
  auto after = static_cast<std::size_t>(std::upper_bound(time_s_.begin(), time_s_.end(), when_s) -
                                        time_s_.begin());
  after = std::clamp<std::size_t>(after, 1, time_s_.size() - 1);
  std::size_t before = after - 1;
  while (before > 0 && !world_from_rig_[before]) --before;
  while (after + 1 < time_s_.size() && !world_from_rig_[after]) ++after;
  if (!world_from_rig_[before] || !world_from_rig_[after]) return std::nullopt;
  const double gap = gap_s(before, after);
  if (gap <= 0 || gap > kLongestGap * period_s_) return std::nullopt;
  const double share = (when_s - time_s_[before]) / gap;
  if (share < -1.5 || share > 2.5) return std::nullopt;  // beyond the ends: too far to extrapolate
  return Span{before, after, share};
}

std::optional<Rigid3> RigPath::motion(std::size_t instant, double offset_s) const {
  if (!world_from_rig_[instant]) return std::nullopt;
  const auto span = span_of(time_s_[instant] + offset_s);
  if (!span) return std::nullopt;
  return between(span->before, span->after, span->share) * world_from_rig_[instant]->inverse();
}

/// How far a frame set lies from the cubic that its two neighbours on each side give.
std::optional<Vector6d> RigPath::off_the_cubic(std::size_t instant) const {
  const auto before = neighbour(instant, -1);
  const auto after = neighbour(instant, 1);
  if (!before || !after) return std::nullopt;
  const auto first = neighbour(*before, -1);
  const auto last = neighbour(*after, 1);
  if (!first || !last) return std::nullopt;
  const auto slope = [&](std::size_t a, std::size_t b) {
    return Vector6d(world_from_rig_[b]->minus(*world_from_rig_[a]) / gap_s(a, b));
  };
  const auto velocity_between = [&](std::size_t a, std::size_t b, std::size_t c) {
    const double share = gap_s(b, c) / gap_s(a, c);
    return Vector6d(share * slope(a, b) + (1.0 - share) * slope(b, c));
  };
  const double gap = gap_s(*before, *after);
  const double share = gap_s(*before, instant) / gap;
  const Rigid3& start = *world_from_rig_[*before];
  const Rigid3 cubic = start.plus(cubic_step(share, world_from_rig_[*after]->minus(start),
                                             gap * velocity_between(*first, *before, *after),
                                             gap * velocity_between(*before, *after, *last)));
  return world_from_rig_[instant]->minus(cubic);
}

void RigPath::measure_wander() {
  std::vector<double> position;
  std::vector<double> rotation;
  for (std::size_t i = 1; i + 1 < time_s_.size(); ++i) {
    if (!world_from_rig_[i]) continue;
    const auto off = off_the_cubic(i);
    if (!off) continue;
    const auto span = std::pair(*neighbour(i, -1), *neighbour(i, 1));
    const double per_s3 =
        cubed(gap_s(span.first, i) * gap_s(i, span.second) / gap_s(span.first, span.second));
    position.push_back(off->head<3>().squaredNorm() / per_s3);
    rotation.push_back(off->tail<3>().squaredNorm() / per_s3);
  }
  if (position.empty()) return;
  wander_ = {upper_median(position) / kMedianOfChi2_3, upper_median(rotation) / kMedianOfChi2_3};
}

double RigPath::wander_s3(std::size_t instant, double offset_s) const {
  const auto span = span_of(time_s_[instant] + offset_s);
  if (!span) return 0;
  const double gap = gap_s(span->before, span->after);
  const double inside = gap * span->share * (1.0 - span->share);
  const double beyond = gap * std::max(-span->share, span->share - 1.0);
  return cubed(beyond > 0 ? beyond : inside);
}

}  // namespace waymark
