#pragma once

#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/upkeep/round_parts.h"

namespace waymark {

/// A marker that an earlier map has and a round did not find, though it looked.
struct MissingMarker {
  MarkerId id;
  int empty_looks = 0;  ///< frame sets that would have shown it
};

/// A marker counts as missing when one that hangs there would be overlooked by all who looked with
/// less than this probability: one false name in many maps. (1e-9–0.01)
inline constexpr double kMissedByChance = 1e-4;

/// Of `markers` (of the earlier map, none of which the part has mapped) those that are not where
/// they should be: so many frame sets of the part look at their place with clear sight
/// (has_clear_sight), and at markers as large as the middle one of those that were read, that a
/// marker which hangs there would have been found, by how seldom the part's own markers are missed.
/// `round_from_old` lays the earlier map into the part's map. By rising id.
[[nodiscard]] std::vector<MissingMarker> find_missing(const RoundParts& round,
                                                      const RoundPart& part,
                                                      const Rigid3& round_from_old,
                                                      const std::vector<const MapMarker*>& markers);

}  // namespace waymark
