#pragma once

#include <string>

#include "core/map/marker_map.h"

namespace waymark {

/// One sub-map as a TUM file of world_from_marker: `id tx ty tz qx qy qz qw`; ids with their family
/// where `with_family` (MarkerMap::several_families) says so, here and below.
[[nodiscard]] std::string format_submap_tum(const SubMap& submap, bool with_family);

/// One sub-map as CSV with a header line: id, family, sizes, world_from_marker, its standard
/// deviations (m; rad about the world's axes; empty where unknown), observations, RMS, verified (1
/// or 0).
[[nodiscard]] std::string format_submap_csv(const SubMap& submap, bool with_family);

/// One sub-map as PLY (ASCII): a square per marker, wound counter-clockwise as seen from its front,
/// with the marker's number and whether it is verified.
[[nodiscard]] std::string format_submap_ply(const SubMap& submap);

}  // namespace waymark
