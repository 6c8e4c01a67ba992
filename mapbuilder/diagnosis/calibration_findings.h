#pragma once

#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// What survey and refinement showed: refusals with their reasons, how far cameras were moved,
/// survey entries that disagree, how well the scale is known without one, sub-maps whose frame its
/// points don't fix, captures whose rig files differ.
[[nodiscard]] std::vector<Finding> calibration_findings(const BuildResult& result,
                                                        const Observations& observations,
                                                        const BuildOptions& options);

}  // namespace waymark
