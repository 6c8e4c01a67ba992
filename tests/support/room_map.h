#pragma once

#include "core/estimate/calibration_prior.h"
#include "core/map/marker_map.h"
#include "tests/support/synthetic_room.h"

namespace waymark::test {

/// The room's markers as an exact map.
inline MarkerMap room_map(const SyntheticRoom& room) {
  MarkerMap map;
  SubMap& submap = map.submaps.emplace_back();
  const Family family = room.catalog.entries().front().family;
  for (std::size_t i = 0; i < room.world_from_marker.size(); ++i) {
    MapMarker marker;
    marker.id = {family, static_cast<int>(i)};
    marker.size_m = *room.catalog.size_m(marker.id);
    marker.stated_size_m = marker.size_m;
    marker.world_from_marker = room.world_from_marker[i];
    marker.verified = true;
    submap.markers.push_back(marker);
  }
  state_exact_sizes(submap);
  return map;
}

}  // namespace waymark::test
