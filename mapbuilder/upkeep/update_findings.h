#pragma once

#include <vector>

#include "core/map/quarantine.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/upkeep/map_update.h"

namespace waymark {

/// What an update tells: who moved, is new, is missing, was left as it was although seen, and
/// whether round and map differ by more than their sigmas say.
[[nodiscard]] std::vector<Finding> update_findings(const MapUpdate& update,
                                                   const UpdateOptions& options, bool with_family);

/// All parts of an update as one comparison with the old map, for quarantine_findings.
[[nodiscard]] FrameComparison whole_comparison(const MapUpdate& update);

}  // namespace waymark
