#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/marker_diagnosis.h"

namespace waymark {

/// The diagnosis in plain words with figures: wrong sizes, markers at two places, then wrong ids
/// (one finding per id that was read wrongly, each detection by camera and stamp).
[[nodiscard]] std::vector<Finding> marker_findings(const Observations& observations,
                                                   const MarkerDiagnosis& diagnosis);

}  // namespace waymark
