#include "core/map/marker_search.h"

#include <algorithm>

#include "core/marker/marker_id_list.h"

namespace waymark {

const MapMarker* find_marker(const SubMap& submap, const MarkerId& id) {
  const auto at = std::lower_bound(
      submap.markers.begin(), submap.markers.end(), id,
      [](const MapMarker& marker, const MarkerId& key) { return marker.id < key; });
  return at != submap.markers.end() && at->id == id ? &*at : nullptr;
}

std::vector<MarkerId> marker_ids(const MarkerMap& map) {
  std::vector<MarkerId> ids;
  for (const SubMap& submap : map.submaps) {
    for (const MapMarker& marker : submap.markers) ids.push_back(marker.id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

Expected<std::vector<FoundMarker>> find_markers(const MarkerMap& map, const std::string& name,
                                                std::span<const MarkerId> ids) {
  std::vector<FoundMarker> found;
  std::vector<MarkerId> absent;
  for (const MarkerId& id : ids) {
    const std::size_t before = found.size();
    for (std::size_t s = 0; s < map.submaps.size(); ++s) {
      if (const MapMarker* marker = find_marker(map.submaps[s], id)) found.push_back({s, marker});
    }
    if (found.size() == before) absent.push_back(id);
  }
  if (absent.empty()) return found;
  std::sort(absent.begin(), absent.end());
  const std::vector<MarkerId> there = marker_ids(map);
  // What is asked for may be of a family that the map lacks.
  MeetingFamilies families = map.families();
  for (const MarkerId& id : absent) families.add(id.family);
  const bool with_family = families.several();
  return fail(ErrorKind::bad_data, "{}: no marker {} in it; its {} markers are {}", name,
              format_marker_ids(absent, with_family), there.size(),
              format_marker_ids(there, with_family));
}

}  // namespace waymark
