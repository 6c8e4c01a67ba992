#pragma once

#include <map>
#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/upkeep/round_parts.h"

namespace waymark {

/// A marker's place by a round and an earlier map together, in the earlier map's world.
struct AdjustedPlace {
  Rigid3 world_from_marker;
  Matrix6d covariance;  ///< marginal; the earlier map's markers taken as independent
};

/// Adjusts a part of a round (eq. 11, markers and rigs) together with what an earlier map knows of
/// the markers that stayed (`known`, MarkerPrior): these alone fix the world. `old_from_round` lays
/// the part's map into that world. Gives every marker that hangs together with one of `known` by
/// frame sets of two markers or more; empty where nothing does, or the system is not determined.
[[nodiscard]] std::map<MarkerId, AdjustedPlace> adjust_with_priors(
    const RoundParts& round, const RoundPart& part, const Rigid3& old_from_round,
    const std::vector<const MapMarker*>& known);

}  // namespace waymark
