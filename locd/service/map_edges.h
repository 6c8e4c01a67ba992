#pragma once

#include <optional>
#include <string>

#include "core/camera/rig.h"
#include "core/map/marker_map.h"

namespace waymark {

/// What to tell of a map whose cameras' edges were measured (some camera's edges are twice as sure
/// there as the rig states them) beside a rig that states no edge bias of that camera: the map is
/// of true size, and locd sees its markers too small. nullopt where there is no such camera.
[[nodiscard]] std::optional<std::string> note_of_map_edges(const MarkerMap& map, const Rig& rig,
                                                           const std::string& map_name);

}  // namespace waymark
