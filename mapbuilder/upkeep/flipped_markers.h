#pragma once

#include <map>

#include "mapbuilder/upkeep/round_parts.h"

namespace waymark {

/// Markers that the views of a part can't tell from themselves flipped, or otherwise ambiguous: of
/// those with an earlier place (`earlier`, in the part's map's world), the placement that is turned
/// less against that (by PlacementOptions::distinct_rad and more), where it explains the part's
/// views as well as any: the runner-up of place_marker, or where the part settles when the marker
/// begins at its earlier place, with a score that is worse by less than
/// GrowthOptions::placement_gap. Empty where views and earlier places say the same, or the views
/// say otherwise for sure.
[[nodiscard]] std::map<MarkerId, Rigid3> unflipped(const RoundParts& round, const RoundPart& part,
                                                   const std::map<MarkerId, Rigid3>& earlier);

}  // namespace waymark
