#pragma once

#include <string>

#include "core/camera/kalibr.h"
#include "core/capture/detections_csv_text.h"
#include "core/map/marker_map.h"
#include "tests/support/synthetic_room.h"
#include "tests/support/temporary_folder.h"

namespace waymark::test {

/// Writes the room as a capture of detections.
inline void write_room_capture(const TemporaryFolder& folder, const SyntheticRoom& room) {
  folder.write("rig.yaml", format_camchain(room.rig));
  folder.write("markers.toml", format_marker_catalog(room.catalog));
  folder.write("detections.csv",
               format_detections_csv(room.images, room.rig, room.catalog, "test"));
}

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
  return map;
}

}  // namespace waymark::test
