#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/map/marker_map.h"

namespace waymark {

/// A marker of a map, and the sub-map that holds it.
struct FoundMarker {
  std::size_t submap = 0;
  const MapMarker* marker = nullptr;  ///< the map's own
};

/// Null where the sub-map, whose markers must be sorted, does not hold it.
[[nodiscard]] const MapMarker* find_marker(const SubMap& submap, const MarkerId& id);

/// All of them, in the order of `ids`. bad_data, naming those that the map lacks and what it holds;
/// `name` stands for the map's path. What is found lives as long as the map.
[[nodiscard]] Expected<std::vector<FoundMarker>> find_markers(const MarkerMap& map,
                                                              const std::string& name,
                                                              std::span<const MarkerId> ids);

/// Those of all sub-maps, rising.
[[nodiscard]] std::vector<MarkerId> marker_ids(const MarkerMap& map);

}  // namespace waymark
