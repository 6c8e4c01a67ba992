#include "mapbuilder/observations/covisibility.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "core/base/check.h"
#include "core/base/disjoint_sets.h"

namespace waymark {

std::vector<Component> connected_components(const Observations& observations,
                                            std::span<const ObservationIndex> edges) {
  const std::size_t marker_count = observations.markers.size();
  DisjointSets sets(marker_count + observations.frame_sets.size());
  std::vector<char> touched(marker_count + observations.frame_sets.size(), 0);
  for (const ObservationIndex index : edges) {
    const std::size_t marker = observations[index].marker.value();
    const std::size_t frame_set = marker_count + observations[index].frame_set.value();
    sets.unite(marker, frame_set);
    touched[marker] = touched[frame_set] = 1;
  }
  std::vector<std::optional<std::size_t>> component_of_root(touched.size());
  std::vector<Component> components;
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (touched[i] == 0) continue;
    auto& index = component_of_root[sets.find(i)];
    if (!index) {
      index = components.size();
      components.emplace_back();
    }
    if (i < marker_count) {
      components[*index].markers.emplace_back(i);
    } else {
      components[*index].frame_sets.emplace_back(i - marker_count);
    }
  }
  std::stable_sort(
      components.begin(), components.end(),
      [](const Component& a, const Component& b) { return a.markers.size() > b.markers.size(); });
  return components;
}

FrameSetIndex choose_seed(const Selection& selection, const Component& component) {
  WAYMARK_CHECK(!component.frame_sets.empty());
  std::optional<FrameSetIndex> best;
  std::pair<std::size_t, double> best_key{0, -1.0};
  for (const FrameSetIndex frame_set : component.frame_sets) {
    std::set<MarkerIndex> markers;
    double area = 0;
    for (const ObservationIndex index : selection.used_in(frame_set)) {
      markers.insert(selection[index].marker);
      area += area_px2(selection[index].corners_px);
    }
    const std::pair<std::size_t, double> key{markers.size(), area};
    if (!best || key > best_key) {
      best = frame_set;
      best_key = key;
    }
  }
  return *best;
}

}  // namespace waymark
