#pragma once

#include <string>

#include "core/camera/kalibr.h"
#include "core/capture/detections_csv_text.h"
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

}  // namespace waymark::test
