#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

/// What could not be used of the observations: ids found twice in one image, corners of no square.
[[nodiscard]] std::vector<Finding> observation_findings(const Observations& observations);

}  // namespace waymark
