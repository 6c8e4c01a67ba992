#include "mapbuilder/diagnosis/wrong_ids.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/range.h"

namespace waymark {
namespace {

std::size_t accepted_views(const std::vector<MarkerView>& views) {
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [](const MarkerView& v) { return v.accepted; }));
}

bool same_place(const SizedPlace& a, const SizedPlace& b) {
  constexpr double kMostApart = 0.3;  // of the side: plates can't overlap that far
  constexpr double kMostTurned_rad = 0.35;
  return (a.world_from_marker.translation - b.world_from_marker.translation).norm() <
             kMostApart * std::max(a.size_m, b.size_m) &&
         angle_between_rad(a.world_from_marker.rotation, b.world_from_marker.rotation) <
             kMostTurned_rad;
}

/// Whether the frame sets of `rare` lie among those of `common` (indices rise with capture and
/// stamp); of two views nothing can be told, and they count as among.
bool among(const std::vector<MarkerView>& rare, const std::vector<MarkerView>& common) {
  constexpr std::size_t kTooFew = 2;
  if (rare.size() <= kTooFew) return true;
  const auto before = [](const MarkerView& a, const MarkerView& b) {
    return a.frame_set < b.frame_set;
  };
  const auto [first, last] = std::minmax_element(rare.begin(), rare.end(), before);
  const auto [begin, end] = std::minmax_element(common.begin(), common.end(), before);
  return before(*begin, *first) && before(*last, *end);
}

}  // namespace

Status WrongIdOptions::check() const {
  return RangeCheck()
      .field("most_to_other", most_to_other, {0.05, 0.4})
      .field("least_to_own", least_to_own, {0.3, 2})
      .field("least_to_own_alone", least_to_own_alone, {0.5, 5})
      .field("least_others_alone", least_others_alone, {2, 10})
      .status();
}

double WrongIdJudge::nearest_px(const MarkerView& view) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const SizedPlace& place : places_[view.marker]) {
    nearest = std::min(nearest, distance_px(view, place));
  }
  return nearest;
}

std::optional<MarkerIndex> WrongIdJudge::marker_shown(const MarkerView& view) const {
  // What a rig's pose by few markers, at the other end of the image, may be off.
  constexpr double kReach = 1.0;  // of the side
  std::optional<MarkerIndex> shown;
  const SizedPlace* where = nullptr;
  const double side = side_px(view);
  double nearest = kReach * side;
  for (const MarkerIndex m : places_.indices()) {
    if (m == view.marker) continue;
    for (const SizedPlace& place : places_[m]) {
      const double distance = distance_px(view, place);
      if (distance >= nearest) continue;
      nearest = distance;
      shown = m;
      where = &place;
    }
  }
  if (where == nullptr || nearest < options_.most_to_other * side) return shown;
  const MarkerObservation as_shown = sized_as(view, where->size_m);
  auto together = evidence_.others_of(view);
  together.push_back({&as_shown, where->world_from_marker});
  const RigPoseSolver solver = evidence_.solver_for(view.frame_set);
  const auto pose = solver.refine(together, *evidence_.world_from_rig(view.frame_set));
  if (!pose) return std::nullopt;
  const bool all_fit = std::all_of(together.begin(), together.end(), [&](const auto& fixed) {
    const auto camera = static_cast<std::size_t>(fixed.observation->camera);
    return squared_residual(
               *fixed.observation, solver.model(camera),
               solver.cam_from_rig(camera) * (pose->pose.inverse() * fixed.world_from_marker)) <=
           evidence_.gate_sigmas2();
  });
  MarkerView moved = view;
  moved.world_from_cam = pose->pose * view.camera->rig_from_cam;
  if (!all_fit || distance_px(moved, *where) >= options_.most_to_other * side) return std::nullopt;
  return shown;
}

std::optional<WrongId> WrongIdJudge::wrong_id(const MarkerView& view) const {
  if (nearest_px(view) < options_.least_to_own * side_px(view)) return {};
  const auto shown = marker_shown(view);
  if (!shown) return {};
  return WrongId{view, shown};
}

std::optional<WrongId> WrongIdJudge::stray(const MarkerView& view) const {
  if (places_[view.marker].empty()) return {};
  if (view.others < options_.least_others_alone) return {};
  if (nearest_px(view) < options_.least_to_own_alone * side_px(view)) return {};
  return WrongId{view, std::nullopt};
}

bool WrongIdJudge::fit_together(const MarkerView& a, const SizedPlace& place_of_a,
                                const MarkerView& b, const SizedPlace& place_of_b) const {
  const MarkerObservation sized_a = sized_as(a, place_of_a.size_m);
  const MarkerObservation sized_b = sized_as(b, place_of_b.size_m);
  const std::array<FixedMarkerObservation, 2> both{
      {{&sized_a, place_of_a.world_from_marker}, {&sized_b, place_of_b.world_from_marker}}};
  RigPoseSolver solver = evidence_.solver_for(a.frame_set);
  const auto found = solver.solve(both);
  return found && std::all_of(both.begin(), both.end(), [&](const auto& fixed) {
           const auto camera = static_cast<std::size_t>(fixed.observation->camera);
           return squared_residual(*fixed.observation, solver.model(camera),
                                   solver.cam_from_rig(camera) *
                                       (found->best.pose.inverse() * fixed.world_from_marker)) <=
                  evidence_.gate_sigmas2();
         });
}

std::optional<MarkerIndex> WrongIdJudge::shown_beside(const MarkerView& view,
                                                      const MarkerView& right) const {
  constexpr double kReach = 3.0;  // of the side: a pose by one marker leaves that much open
  if (!right.observation->ippe) return std::nullopt;
  for (const SizedPlace& own : places_[right.marker]) {
    const MarkerObservation as_own = sized_as(right, own.size_m);
    for (const Rigid3& cam_from_marker : as_own.ippe->cam_from_marker) {
      MarkerView there = view;
      there.world_from_cam = own.world_from_marker * cam_from_marker.inverse() *
                             right.camera->rig_from_cam.inverse() * view.camera->rig_from_cam;
      for (const MarkerIndex m : places_.indices()) {
        if (m == view.marker) continue;
        for (const SizedPlace& place : places_[m]) {
          if (distance_px(there, place) < kReach * side_px(view) &&
              fit_together(view, place, right, own)) {
            return m;
          }
        }
      }
    }
  }
  return std::nullopt;
}

std::optional<WrongId> WrongIdJudge::wrong_of_two(FrameSetIndex frame_set) const {
  const std::vector<MarkerView> views = evidence_.views_in(frame_set);
  if (views.size() != 2) return {};
  const MarkerView& a = views[0];
  const MarkerView& b = views[1];
  for (const SizedPlace& place_of_a : places_[a.marker]) {
    for (const SizedPlace& place_of_b : places_[b.marker]) {
      if (fit_together(a, place_of_a, b, place_of_b)) return {};
    }
  }
  const auto shown_by_a = shown_beside(a, b);
  const auto shown_by_b = shown_beside(b, a);
  if (shown_by_a.has_value() == shown_by_b.has_value()) return {};
  return shown_by_a ? WrongId{a, shown_by_a} : WrongId{b, shown_by_b};
}

bool stands_on_another(const MapEvidence& evidence, MarkerIndex marker) {
  constexpr std::size_t kTimesAsOften = 2;
  const auto& own = evidence.place(marker);
  if (!own) return false;
  const auto views = evidence.views_of(marker, 0);
  for (const MarkerIndex m : evidence.markers()) {
    const auto& other = evidence.place(m);
    if (m == marker || !other || !same_place(*own, *other)) continue;
    const auto others = evidence.views_of(m, 0);
    if (accepted_views(others) >= kTimesAsOften * std::max<std::size_t>(1, accepted_views(views)) &&
        among(views, others)) {
      return true;
    }
  }
  return false;
}

}  // namespace waymark
