#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/mapping/map_builder.h"

namespace waymark {

/// What survey and refinement showed: refusals with their reasons, how far cameras were moved,
/// survey entries that disagree, how well the scale is known without one, sub-maps whose frame its
/// points don't fix, captures whose rig files differ.
[[nodiscard]] std::vector<Finding> calibration_findings(const BuildResult& result,
                                                        const ObservationTable& table,
                                                        const BuildOptions& options);

}  // namespace waymark
