#pragma once

#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// What is wrong with a finished map, above all one measured by hand, by a map of the same markers
/// that was built of a capture alone: another place, another unit, sizes of another scale, centres
/// off alike, mirrored, orientations by other axes (other_place, map_misfit: errors); entries
/// exchanged, off, turned or of another size (map_entry, of a built map moved: warnings); turned
/// only where `observations`, which the own map was built of, speak against it. Nothing where the
/// two share fewer than three markers or only ones on a line.
[[nodiscard]] std::vector<Finding> map_findings(const MarkerMap& map, const BuildResult& own,
                                                const Observations& observations);

/// Whether two sub-maps that share four markers or more have most of them standing to each other
/// otherwise; false where nothing tells.
[[nodiscard]] bool are_of_different_places(const SubMap& a, const SubMap& b);

}  // namespace waymark
