#include "mapbuilder/diagnosis/rig_time_hypotheses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapbuilder/diagnosis/best_change.h"
#include "mapbuilder/diagnosis/least_cost.h"
#include "mapbuilder/diagnosis/rig_path.h"

namespace waymark {
namespace {

double milliseconds(double seconds) { return seconds * 1e3; }

/// What of a camera was seen `offset_s` after the stamps, on the path of the others.
double cost_when_later(const RigCase& rig, const RigPath& path, std::size_t camera,
                       double offset_s) {
  double sum = 0;
  for (const std::size_t i : rig.fit().judged()) {
    const auto& place = rig.tracks().instants[i].places[camera];
    if (!place || !path.at(i)) continue;
    const auto motion = path.motion(i, offset_s);
    const Rigid3 there = motion ? *motion * *path.at(i) : *path.at(i);
    sum += bounded_misfit(
        squared_misfit(*place, there * rig.stated()[camera], 2.0 * rig.fit().noise_scale()));
  }
  return sum;
}

/// A camera's places moved to the frame set's stamp from `offset_s` later on the others' path.
CameraTracks moved_in_time(const RigCase& rig, const RigPath& path, std::size_t camera,
                           double offset_s) {
  CameraTracks tracks = rig.tracks();
  for (const std::size_t i : rig.fit().judged()) {
    auto& place = tracks.instants[i].places[camera];
    if (!place) continue;
    const auto motion = path.motion(i, offset_s);
    if (motion) place->world_from_cam = motion->inverse() * place->world_from_cam;
  }
  return tracks;
}

/// A camera's places those of so many instants before.
CameraTracks shifted(const CameraTracks& tracks, std::size_t camera, int by) {
  CameraTracks in_step = tracks;
  const auto count = static_cast<std::ptrdiff_t>(tracks.instants.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t source = i - by;
    auto& place = in_step.instants[static_cast<std::size_t>(i)].places[camera];
    place.reset();
    if (source >= 0 && source < count) {
      place = tracks.instants[static_cast<std::size_t>(source)].places[camera];
    }
  }
  return in_step;
}

std::optional<RigHypothesis> out_of_step(const RigCase& rig, std::size_t camera, int shift,
                                         const std::vector<double>& as_paired) {
  constexpr std::size_t kFewest = 3;  // instants on each side of the change
  CameraTracks in_step = shifted(rig.tracks(), camera, shift);
  const Change change = best_change(as_paired, rig.fit().costs(in_step, rig.stated()));
  if (!change.splits(rig.fit().judged().size(), kFewest)) return std::nullopt;
  RigHypothesis h = rig.hypothesis();
  h.since = rig.fit().judged()[change.at];
  h.numbers = 2;
  for (std::size_t i = 0; i < h.since; ++i) {
    in_step.instants[i].places[camera] = rig.tracks().instants[i].places[camera];
  }
  h.tracks = std::make_shared<const CameraTracks>(std::move(in_step));
  rig.evaluate(h, rig.stated());
  RigExplanation& e = h.explanation;
  e.cause = Cause::frame_order;
  e.cameras = {camera};
  e.value = shift;
  e.unit = "frames";
  e.since = rig.tracks().instants[h.since].stamp;
  e.detail = fmt::format(
      "from frame set {} on its images show what the others saw {} frame{} {}: a lost frame?",
      e.since->count(), std::abs(shift), std::abs(shift) == 1 ? "" : "s",
      shift > 0 ? "later" : "earlier");
  e.remedy =
      "Pair images by their stamps, not by number; or leave that camera's images out from there "
      "on.";
  e.rig_from_cam = rig.stated();
  e.leave_out = true;
  return h;
}

}  // namespace

std::optional<RigHypothesis> late_hypothesis(const RigCase& rig, std::size_t camera) {
  const RigPath path(rig.tracks(), rig.stated(), rig.fit().noise_scale(), static_cast<int>(camera));
  if (!path.moves()) return std::nullopt;
  const auto cost = [&](double offset_s) { return cost_when_later(rig, path, camera, offset_s); };
  const double most_s = std::max(0.5, 3.0 * path.period_s());
  const double step_s = std::min(0.01, path.period_s() / 8.0);
  const LeastCost fitted = least_cost(-most_s, most_s, step_s, cost, cost);
  RigHypothesis h = rig.hypothesis();
  h.tracks = std::make_shared<const CameraTracks>(moved_in_time(rig, path, camera, fitted.at));
  h.numbers = 1;
  rig.evaluate(h, rig.stated());
  RigExplanation& e = h.explanation;
  e.cause = Cause::clock;
  e.cameras = {camera};
  e.value = -milliseconds(fitted.at);
  e.sigma = milliseconds(fitted.sigma);
  e.unit = "ms";
  e.detail = fmt::format("its images are {:.1f} ± {:.1f} ms {} than their stamps say, against {}",
                         std::abs(e.value), std::max(0.1, e.sigma), e.value > 0 ? "older" : "newer",
                         rig.names_but(camera));
  e.remedy =
      "Trigger the cameras together, stamp them by one clock, or state the delay where stamps are "
      "made.";
  e.rig_from_cam = rig.stated();
  e.leave_out = true;
  return h;
}

std::vector<RigHypothesis> out_of_step_hypotheses(const RigCase& rig, std::size_t camera) {
  const std::vector<double> as_paired = rig.fit().costs(rig.tracks(), rig.stated());
  std::vector<RigHypothesis> all;
  for (const int shift : {-3, -2, -1, 1, 2, 3}) {
    if (auto h = out_of_step(rig, camera, shift, as_paired)) all.push_back(*std::move(h));
  }
  return all;
}

}  // namespace waymark
