#include "mapbuilder/observations/covisibility.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/base/disjoint_sets.h"

namespace waymark {
std::vector<Component> connected_components(const ObservationTable& table,
                                            const std::vector<char>& used) {
  const std::size_t marker_count = table.markers.size();
  DisjointSets sets(marker_count + table.frame_sets.size());
  std::vector<char> touched(marker_count + table.frame_sets.size(), 0);
  for (std::size_t i = 0; i < table.observations.size(); ++i) {
    if (used[i] == 0) continue;
    const auto marker = static_cast<std::size_t>(table.observations[i].marker);
    const auto frame_set = marker_count + static_cast<std::size_t>(table.observations[i].frame_set);
    sets.unite(marker, frame_set);
    touched[marker] = touched[frame_set] = 1;
  }
  std::vector<int> component_of_root(touched.size(), -1);
  std::vector<Component> components;
  for (std::size_t i = 0; i < touched.size(); ++i) {
    if (touched[i] == 0) continue;
    int& index = component_of_root[sets.find(i)];
    if (index < 0) {
      index = static_cast<int>(components.size());
      components.emplace_back();
    }
    Component& component = components[static_cast<std::size_t>(index)];
    if (i < marker_count) {
      component.markers.push_back(static_cast<int>(i));
    } else {
      component.frame_sets.push_back(static_cast<int>(i - marker_count));
    }
  }
  std::stable_sort(
      components.begin(), components.end(),
      [](const Component& a, const Component& b) { return a.markers.size() > b.markers.size(); });
  return components;
}

int choose_seed(const ObservationTable& table, const Component& component) {
  WAYMARK_CHECK(!component.frame_sets.empty());
  int best = -1;
  std::pair<std::size_t, double> best_key{0, -1.0};
  for (const int index : component.frame_sets) {
    const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(index)];
    std::vector<int> markers;
    double area = 0;
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const TableObservation& o = table.observations[set.first_observation + i];
      markers.push_back(o.marker);
      area += area_px2(o.corners_px);
    }
    std::sort(markers.begin(), markers.end());
    const auto distinct = std::unique(markers.begin(), markers.end()) - markers.begin();
    const std::pair<std::size_t, double> key{static_cast<std::size_t>(distinct), area};
    if (best < 0 || key > best_key) {
      best = index;
      best_key = key;
    }
  }
  return best;
}

}  // namespace waymark
