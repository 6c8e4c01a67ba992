#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/mapping/map_builder.h"

namespace waymark {

/// What survey and refinement showed: refusals with their reasons, how far cameras were moved, how
/// sizes and edges fit, survey entries that disagree or determine nothing.
[[nodiscard]] std::vector<Finding> calibration_findings(const BuildResult& result,
                                                        const BuildOptions& options);

}  // namespace waymark
