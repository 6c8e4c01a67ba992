#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/camera/rig.h"
#include "core/map/marker_map.h"

namespace waymark {

/// What there is to tell of a map that poses are to be found in with a rig.
struct MapRigNotes {
  std::vector<std::string> warnings;  ///< the wrong rig file: poses are worse than they need to be
  std::vector<std::string> notes;
};

/// Tells of sub-maps that are not used, markers of unknown uncertainty, another calibration, sigmas
/// that the rig does not state; and warns of a map for which cameras' edges were measured
/// (knows_edges_better) beside a rig that does not state them: the map is of true size, and the
/// vehicle sees its markers too small. Paths are named as given.
[[nodiscard]] MapRigNotes map_rig_notes(const MarkerMap& map, const std::filesystem::path& map_path,
                                        const Rig& rig, const std::filesystem::path& rig_path);

}  // namespace waymark
