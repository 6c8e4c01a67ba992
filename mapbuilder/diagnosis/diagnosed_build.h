#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/marker_diagnosis.h"

namespace waymark {

/// A build with what is wrong with its markers.
struct DiagnosedBuild {
  BuildResult result;
  std::vector<Finding> findings;  ///< of markers; build_findings has the rest
};

/// Builds the map, looks for wrong ids, twins, moved markers and wrong sizes, and builds again
/// without them (with the fitted sizes) until the diagnosis stays the same, five times at most;
/// once where the map rests on nothing that is wrong. Every diagnosis judges all observations,
/// those left out before included: what only seemed wrong in a map that something worse had bent is
/// acquitted. `first` is the first of these builds where it was made already, with the same
/// options.
[[nodiscard]] DiagnosedBuild build_and_diagnose(const Observations& observations,
                                                const BuildOptions& options,
                                                const DiagnosisOptions& diagnosis,
                                                Progress& progress,
                                                std::optional<BuildResult> first = std::nullopt);

}  // namespace waymark
