#include "mapbuilder/diagnosis/rig_place_hypotheses.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "mapbuilder/diagnosis/best_change.h"

namespace waymark {
namespace {

/// Fewer instants on a side of a moment tell nothing apart.
constexpr std::size_t kFewest = 3;

double turn_deg(const Rigid3& a, const Rigid3& b) {
  return angle_between_rad(a.rotation, b.rotation) * 180.0 / std::numbers::pi;
}

double distance_mm(const Rigid3& a, const Rigid3& b) {
  return 1e3 * (a.translation - b.translation).norm();
}

/// The rig before and after a camera was bumped.
struct Bump {
  Extrinsics sound;
  Extrinsics moved;
  Change change;
};

/// `later`: the camera fits the rig file before the moment; else after it. Moment and places in
/// turn.
std::optional<Bump> bump_of(const RigCase& rig, std::size_t camera, bool later) {
  const RigFit& fit = rig.fit();
  const std::size_t count = fit.judged().size();
  const std::size_t third = count / 3;
  if (third < kFewest) return std::nullopt;
  const auto place = fit.place_by_others(
      rig.tracks(), camera, later ? InstantRange{count - third, count} : InstantRange{0, third});
  if (!place) return std::nullopt;
  Bump bump{rig.stated(), rig.stated(), {}};
  bump.moved[camera] = *place;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const auto as_file = fit.costs(rig.tracks(), bump.sound);
    const auto as_moved = fit.costs(rig.tracks(), bump.moved);
    bump.change = later ? best_change(as_file, as_moved) : best_change(as_moved, as_file);
    if (!bump.change.splits(count, kFewest)) return std::nullopt;
    const InstantRange before{0, bump.change.at};
    const InstantRange after{bump.change.at, count};
    bump.moved =
        fit.fit(rig.tracks(), bump.moved, FreeCameras::one(camera), later ? after : before);
    bump.sound = fit.fit(rig.tracks(), rig.stated(), FreeCameras::none(), later ? before : after);
  }
  return bump;
}

RigHypothesis bumped(const RigCase& rig, std::size_t camera, const Bump& bump, bool later) {
  const RigFit& fit = rig.fit();
  const std::size_t at = bump.change.at;
  RigHypothesis h = rig.hypothesis();
  h.since = fit.judged()[at];
  h.rig = later ? bump.moved : bump.sound;
  h.rig_before = later ? bump.sound : bump.moved;
  h.numbers = 7;
  h.cost = fit.cost(rig.tracks(), h.rig_before, {0, at}) +
           fit.cost(rig.tracks(), h.rig, {at, fit.judged().size()}) +
           fit.prior_cost(bump.sound, rig.stated(), FreeCameras::none());
  const Rigid3& there = bump.moved[camera];
  const Rigid3& stated = rig.stated()[camera];
  const char* sound_half = later ? "before" : "after";
  RigExplanation& e = h.explanation;
  e.cause = Cause::rig_bumped;
  e.cameras = {camera};
  e.value = turn_deg(there, stated);
  e.unit = "°";
  e.since = rig.tracks().instants[h.since].stamp;
  const double at_s = in_s(*e.since - rig.tracks().instants.front().stamp);
  e.detail = fmt::format(
      "was turned by {:.1f}° and moved by {:.0f} mm at about {:.1f} s (frame set {}); {} that it "
      "fits rig.yaml",
      e.value, distance_mm(there, stated), at_s, e.since->count(), sound_half);
  e.remedy = fmt::format(
      "Use the images {} that, or calibrate anew for the others; fasten the camera.", sound_half);
  e.rig_from_cam = rig.stated();
  e.leave_out = true;
  return h;
}

/// The place on the rig that most instants give a camera which the first one shares.
std::optional<Rigid3> place_by_first(const RigCase& rig, std::size_t camera) {
  CameraTracks pair = rig.tracks();
  for (auto& instant : pair.instants) {
    for (std::size_t k = 1; k < rig.cameras(); ++k) {
      if (k != camera) instant.places[k].reset();
    }
  }
  return rig.fit().place_by_others(pair, camera, rig.fit().all());
}

}  // namespace

std::vector<RigHypothesis> bumped_hypotheses(const RigCase& rig, std::size_t camera) {
  std::vector<RigHypothesis> all;
  for (const bool later : {true, false}) {
    if (const auto bump = bump_of(rig, camera, later)) {
      all.push_back(bumped(rig, camera, *bump, later));
    }
  }
  return all;
}

std::optional<RigHypothesis> displaced_hypothesis(const RigCase& rig, std::size_t camera) {
  const auto place = rig.fit().place_by_others(rig.tracks(), camera, rig.fit().all());
  if (!place) return std::nullopt;
  Extrinsics start = rig.stated();
  start[camera] = *place;
  RigHypothesis h = rig.hypothesis();
  h.numbers = 6;
  rig.evaluate(h, start, FreeCameras::one(camera));
  RigExplanation& e = h.explanation;
  e.cause = Cause::rig_displaced;
  e.cameras = {camera};
  e.value = 1e-3 * distance_mm(h.rig[camera], rig.stated()[camera]);
  e.unit = "m";
  e.detail = fmt::format("stands {:.1f} mm and {:.2f}° away from where rig.yaml has it",
                         1e3 * e.value, turn_deg(h.rig[camera], rig.stated()[camera]));
  e.remedy =
      "See whether it was moved or its entry mistyped; calibrate the rig anew, or build with "
      "--refine extrinsics.";
  return h;
}

std::optional<RigHypothesis> all_displaced_hypothesis(const RigCase& rig) {
  Extrinsics start = rig.stated();
  for (std::size_t k = 1; k < rig.cameras(); ++k) {
    if (const auto place = place_by_first(rig, k)) start[k] = *place;
  }
  RigHypothesis h = rig.hypothesis();
  h.numbers = 6 * (static_cast<int>(rig.cameras()) - 1);
  rig.evaluate(h, start, FreeCameras::all());
  RigExplanation& e = h.explanation;
  e.cause = Cause::rig_displaced;
  e.unit = "m";
  constexpr double kWorthNaming = 5.0;  // stated sigmas
  for (std::size_t k = 1; k < rig.cameras(); ++k) {
    if (rig.fit().stated_sigmas(h.rig[k], rig.stated()[k]) < kWorthNaming) continue;
    const double moved_mm = distance_mm(h.rig[k], rig.stated()[k]);
    e.cameras.push_back(k);
    e.value = std::max(e.value, 1e-3 * moved_mm);
    e.detail += fmt::format("{}{:.1f} mm and {:.2f}°", e.detail.empty() ? "stand " : ", ", moved_mm,
                            turn_deg(h.rig[k], rig.stated()[k]));
  }
  if (e.cameras.empty()) return std::nullopt;
  e.detail += fmt::format(" away from where rig.yaml has them against {}", rig.name(0));
  e.remedy =
      "See whether they were moved; calibrate the rig anew, or build with --refine extrinsics.";
  return h;
}

}  // namespace waymark
