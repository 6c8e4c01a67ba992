#include "mapbuilder/diagnosis/wrong_ids.h"

#include <algorithm>
#include <array>
#include <limits>

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
    return a.observation->frame_set < b.observation->frame_set;
  };
  const auto [first, last] = std::minmax_element(rare.begin(), rare.end(), before);
  const auto [begin, end] = std::minmax_element(common.begin(), common.end(), before);
  return before(*begin, *first) && before(*last, *end);
}

}  // namespace

double WrongIdJudge::nearest_px(const MarkerView& view) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const SizedPlace& place : places_[static_cast<std::size_t>(view.observation->marker)]) {
    nearest = std::min(nearest, distance_px(view, place));
  }
  return nearest;
}

int WrongIdJudge::marker_shown(const MarkerView& view) const {
  // What a rig's pose by few markers, at the other end of the image, may be off.
  constexpr double kReach = 1.0;  // of the side
  int shown = -1;
  const SizedPlace* where = nullptr;
  const double side = side_px(view);
  double nearest = kReach * side;
  for (std::size_t m = 0; m < places_.size(); ++m) {
    if (static_cast<int>(m) == view.observation->marker) continue;
    for (const SizedPlace& place : places_[m]) {
      const double distance = distance_px(view, place);
      if (distance >= nearest) continue;
      nearest = distance;
      shown = static_cast<int>(m);
      where = &place;
    }
  }
  if (where == nullptr || nearest < options_.most_to_other * side) return shown;
  const MarkerObservation as_shown = sized_as(view, where->size_m);
  auto together = evidence_.others_of(view);
  together.push_back({&as_shown, where->world_from_marker});
  const RigPoseSolver solver = evidence_.solver_for(view.observation->frame_set);
  const auto pose = solver.refine(together, *evidence_.world_from_rig(view.observation->frame_set));
  if (!pose) return -1;
  const bool all_fit = std::all_of(together.begin(), together.end(), [&](const auto& fixed) {
    const auto camera = static_cast<std::size_t>(fixed.observation->camera);
    return squared_residual(
               *fixed.observation, solver.model(camera),
               solver.cam_from_rig(camera) * (pose->pose.inverse() * fixed.world_from_marker)) <=
           evidence_.gate_sigmas2();
  });
  MarkerView moved = view;
  moved.world_from_cam = pose->pose * view.camera->rig_from_cam;
  return all_fit && distance_px(moved, *where) < options_.most_to_other * side ? shown : -1;
}

std::optional<WrongId> WrongIdJudge::wrong_id(const MarkerView& view) const {
  if (nearest_px(view) < options_.least_to_own * side_px(view)) return {};
  const int shown = marker_shown(view);
  if (shown < 0) return {};
  return WrongId{view, shown};
}

std::optional<WrongId> WrongIdJudge::stray(const MarkerView& view) const {
  if (places_[static_cast<std::size_t>(view.observation->marker)].empty()) return {};
  if (view.others < options_.least_others_alone) return {};
  if (nearest_px(view) < options_.least_to_own_alone * side_px(view)) return {};
  return WrongId{view, -1};
}

bool WrongIdJudge::fit_together(const MarkerView& a, const SizedPlace& place_of_a,
                                const MarkerView& b, const SizedPlace& place_of_b) const {
  const MarkerObservation sized_a = sized_as(a, place_of_a.size_m);
  const MarkerObservation sized_b = sized_as(b, place_of_b.size_m);
  const std::array<FixedMarkerObservation, 2> both{
      {{&sized_a, place_of_a.world_from_marker}, {&sized_b, place_of_b.world_from_marker}}};
  RigPoseSolver solver = evidence_.solver_for(a.observation->frame_set);
  const auto found = solver.solve(both);
  return found && std::all_of(both.begin(), both.end(), [&](const auto& fixed) {
           const auto camera = static_cast<std::size_t>(fixed.observation->camera);
           return squared_residual(*fixed.observation, solver.model(camera),
                                   solver.cam_from_rig(camera) *
                                       (found->best.pose.inverse() * fixed.world_from_marker)) <=
                  evidence_.gate_sigmas2();
         });
}

int WrongIdJudge::shown_beside(const MarkerView& view, const MarkerView& right) const {
  constexpr double kReach = 3.0;  // of the side: a pose by one marker leaves that much open
  if (!right.observation->ippe) return -1;
  for (const SizedPlace& own : places_[static_cast<std::size_t>(right.observation->marker)]) {
    const MarkerObservation as_own = sized_as(right, own.size_m);
    for (const Rigid3& cam_from_marker : as_own.ippe->cam_from_marker) {
      MarkerView there = view;
      there.world_from_cam = own.world_from_marker * cam_from_marker.inverse() *
                             right.camera->rig_from_cam.inverse() * view.camera->rig_from_cam;
      for (std::size_t m = 0; m < places_.size(); ++m) {
        if (static_cast<int>(m) == view.observation->marker) continue;
        for (const SizedPlace& place : places_[m]) {
          if (distance_px(there, place) < kReach * side_px(view) &&
              fit_together(view, place, right, own)) {
            return static_cast<int>(m);
          }
        }
      }
    }
  }
  return -1;
}

std::optional<WrongId> WrongIdJudge::wrong_of_two(int frame_set) const {
  const std::vector<MarkerView> views = evidence_.views_in(frame_set);
  if (views.size() != 2) return {};
  const MarkerView& a = views[0];
  const MarkerView& b = views[1];
  for (const SizedPlace& place_of_a : places_[static_cast<std::size_t>(a.observation->marker)]) {
    for (const SizedPlace& place_of_b : places_[static_cast<std::size_t>(b.observation->marker)]) {
      if (fit_together(a, place_of_a, b, place_of_b)) return {};
    }
  }
  const int shown_by_a = shown_beside(a, b);
  const int shown_by_b = shown_beside(b, a);
  if ((shown_by_a < 0) == (shown_by_b < 0)) return {};
  return shown_by_a >= 0 ? WrongId{a, shown_by_a} : WrongId{b, shown_by_b};
}

bool stands_on_another(const MapEvidence& evidence, int marker) {
  constexpr std::size_t kTimesAsOften = 2;
  const auto& own = evidence.place(marker);
  if (!own) return false;
  const auto views = evidence.views_of(marker, 0);
  for (const int m : evidence.markers()) {
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
