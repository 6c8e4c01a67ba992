#include "core/map/map_edit.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/map/marker_search.h"
#include "core/marker/marker_id_list.h"

namespace waymark {
namespace {

/// What the edit says whatever the map holds.
Status check_renames(const MapEdit& edit) {
  std::set<MarkerId> renamed;
  std::set<MarkerId> named;
  for (const auto& [from, to] : edit.rename) {
    const std::string pair =
        fmt::format("--rename {}={}", format_marker_id(from, true), format_marker_id(to, true));
    if (from == to) return fail(ErrorKind::usage, "{}: that is its name already", pair);
    if (from.family != to.family) {
      return fail(ErrorKind::usage,
                  "{}: of another family, whose prints have another upright and size: map it anew",
                  pair);
    }
    if (!renamed.insert(from).second) {
      return fail(ErrorKind::usage, "{}: this marker is renamed twice", pair);
    }
    if (!named.insert(to).second) {
      return fail(ErrorKind::usage, "{}: two markers would get this name", pair);
    }
  }
  return {};
}

Status check_removed(const MapEdit& edit) {
  const std::set<MarkerId> removed(edit.remove.begin(), edit.remove.end());
  std::vector<MarkerId> kept = edit.accept;
  for (const auto& [from, to] : edit.rename) kept.push_back(from);
  for (const MarkerId& id : kept) {
    if (!removed.contains(id)) continue;
    return fail(ErrorKind::usage, "marker {}: is removed, and renamed or accepted: which of them?",
                format_marker_id(id, true));
  }
  return {};
}

/// Every id that the edit takes to be in the map.
std::vector<MarkerId> ids_before(const MapEdit& edit) {
  std::set<MarkerId> ids(edit.remove.begin(), edit.remove.end());
  ids.insert(edit.accept.begin(), edit.accept.end());
  for (const auto& [from, to] : edit.rename) ids.insert(from);
  return {ids.begin(), ids.end()};
}

/// No two markers may have one id.
Status check_collisions(const MarkerMap& map, const std::string& name) {
  std::vector<MarkerId> ids = marker_ids(map);
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  if (twice == ids.end()) return {};
  return fail(ErrorKind::bad_data,
              "{}: --rename would make two markers {}: remove or rename the one that has this name",
              name, format_marker_id(*twice, map.several_families()));
}

}  // namespace

void sort_map(MarkerMap& map) {
  for (SubMap& submap : map.submaps) {
    std::sort(submap.markers.begin(), submap.markers.end(),
              [](const MapMarker& a, const MapMarker& b) { return a.id < b.id; });
  }
  std::stable_sort(map.submaps.begin(), map.submaps.end(), [](const SubMap& a, const SubMap& b) {
    if (a.markers.size() != b.markers.size()) return a.markers.size() > b.markers.size();
    return a.markers.front().id < b.markers.front().id;
  });
}

Expected<MarkerMap> edit_map(const MarkerMap& map, const std::string& name, const MapEdit& edit) {
  if (auto fine = check_renames(edit); !fine) return tl::make_unexpected(fine.error());
  if (auto fine = check_removed(edit); !fine) return tl::make_unexpected(fine.error());
  if (auto found = find_markers(map, name, ids_before(edit)); !found) {
    return tl::make_unexpected(found.error());
  }
  const std::set<MarkerId> removed(edit.remove.begin(), edit.remove.end());
  const std::set<MarkerId> accepted(edit.accept.begin(), edit.accept.end());
  const std::map<MarkerId, MarkerId> renamed(edit.rename.begin(), edit.rename.end());
  MarkerMap edited = map;
  for (SubMap& submap : edited.submaps) {
    std::erase_if(submap.markers, [&](const MapMarker& m) { return removed.contains(m.id); });
    for (MapMarker& marker : submap.markers) {
      if (accepted.contains(marker.id)) marker.verified = true;
      if (const auto to = renamed.find(marker.id); to != renamed.end()) marker.id = to->second;
    }
  }
  std::erase_if(edited.submaps, [](const SubMap& submap) { return submap.markers.empty(); });
  if (edited.submaps.empty()) {
    return fail(ErrorKind::bad_data, "{}: no marker would be left; a map holds one at least", name);
  }
  if (auto fine = check_collisions(edited, name); !fine) return tl::make_unexpected(fine.error());
  sort_map(edited);
  return edited;
}

}  // namespace waymark
