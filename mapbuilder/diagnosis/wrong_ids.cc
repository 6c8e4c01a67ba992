#include "mapbuilder/diagnosis/wrong_ids.h"

#include <algorithm>
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

double nearest_px(const MarkerView& view, std::span<const SizedPlace> places) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const SizedPlace& place : places) nearest = std::min(nearest, distance_px(view, place));
  return nearest;
}

int marker_shown(const MarkerView& view, std::span<const std::vector<SizedPlace>> places,
                 const WrongIdOptions& options) {
  int shown = -1;
  double nearest = options.most_to_other * side_px(view);
  for (std::size_t m = 0; m < places.size(); ++m) {
    if (static_cast<int>(m) == view.observation->marker) continue;
    const double distance = nearest_px(view, places[m]);
    if (distance >= nearest) continue;
    nearest = distance;
    shown = static_cast<int>(m);
  }
  return shown;
}

bool stands_on_another(const MapEvidence& evidence, int marker) {
  constexpr std::size_t kTimesAsOften = 3;
  const auto& own = evidence.place(marker);
  if (!own) return false;
  const auto views = evidence.views_of(marker, 0);
  for (std::size_t m = 0; m < evidence.table().markers.size(); ++m) {
    const auto& other = evidence.place(static_cast<int>(m));
    if (static_cast<int>(m) == marker || !other || !same_place(*own, *other)) continue;
    const auto others = evidence.views_of(static_cast<int>(m), 0);
    if (accepted_views(others) >= kTimesAsOften * std::max<std::size_t>(1, accepted_views(views)) &&
        among(views, others)) {
      return true;
    }
  }
  return false;
}

}  // namespace waymark
