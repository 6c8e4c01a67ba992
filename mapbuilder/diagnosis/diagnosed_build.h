#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/marker_diagnosis.h"
#include "mapbuilder/mapping/map_builder.h"

namespace waymark {

/// A build with what is wrong with its markers.
struct DiagnosedBuild {
  BuildResult result;
  std::vector<Finding> findings;  ///< of markers; build_findings has the rest
};

/// Builds the map, looks for wrong ids, twins, moved markers and wrong sizes, and builds again
/// without them (with the fitted sizes) until nothing more is found, three times at most. The table
/// afterwards holds what the map rests on; `stated_size_m` of the map stays what was stated.
[[nodiscard]] DiagnosedBuild build_and_diagnose(ObservationTable& table,
                                                const BuildOptions& options,
                                                const DiagnosisOptions& diagnosis,
                                                Progress& progress);

}  // namespace waymark
