#pragma once

#include <vector>

#include "core/base/error.h"
#include "mapbuilder/diagnosis/diagnosed_build.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// A build whose captures were put right where rig file, clocks or lenses contradict the images,
/// and sizes and survey where they contradict each other.
struct ExplainedBuild {
  Observations observations;  ///< of the captures put right
  DiagnosedBuild diagnosed;
  Survey survey;                ///< as the map takes it
  std::vector<Finding> causes;  ///< what was put right, or left out
};

/// Builds and diagnoses the map of captures, from the top of the chain: where the observations
/// contradict the build as a whole, or another rig would explain it much better, the cause is
/// looked for in prints, lenses, rig file and clocks first (explain_captures). What is then built
/// without the survey is held against it (judge_survey), so that an entry that disagrees bends
/// neither map nor sizes. Markers are judged only by what is left when all that is out of the way.
/// A camera that merely stands elsewhere than stated is left to the calibration's own judgement
/// (calibration_findings). `observations` are those of the captures, made as `observing` says.
/// Errors: those of make_observations.
[[nodiscard]] Expected<ExplainedBuild> build_explained(const std::vector<DetectedCapture>& captures,
                                                       Observations observations,
                                                       const ObservationOptions& observing,
                                                       const BuildOptions& options,
                                                       Progress& progress);

/// Findings but for doubts about lens or place of cameras that a cause has named: what is left of
/// it when it was put right by a fit is no second fault.
[[nodiscard]] std::vector<Finding> not_explained(std::vector<Finding> findings,
                                                 const std::vector<Finding>& causes);

}  // namespace waymark
