#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

/// Whether the rig file's translations are metres, by the cameras' own motions alone: between two
/// frame sets every camera sees how it moved by its own markers; on a rig that turns these motions
/// differ by what its baselines are. Errors where they are 1000, 100 or 39.37 times too long
/// (rig_unit), or as much too short: then the markers' sizes are meant otherwise (size_scale).
/// Where nothing tells, a warning for baselines that hardly a rig has.
[[nodiscard]] std::vector<Finding> baseline_findings(const Observations& observations);

}  // namespace waymark
