#pragma once

#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// Captures with what keeps their cameras from fitting together put right, or left out.
struct ExplainedCaptures {
  std::vector<DetectedCapture> captures;
  std::vector<Finding> findings;  ///< one per cause, errors
};

/// Looks for what is wrong with prints, lenses, rig file or clocks, from the simplest on, where a
/// build contradicts its observations: builds the map once more with every image on its own. Where
/// that leaves more than corners are worth, prints that are not square (fit_print_shape) and each
/// camera's lens (lens_evidence) are asked; by lenses that fit, where the cameras stood is held
/// against the rig (explain_rig), and what of the lenses that does not explain is told
/// (correct_lenses). What is found is put right in the captures returned, or left out of them (a
/// camera's images where its time is wrong), so that the rest can be judged anew. No findings where
/// no cause stands out. `joint_px` is what the build of the captures as they are misses by
/// (FitQuality).
[[nodiscard]] ExplainedCaptures explain_captures(const std::vector<DetectedCapture>& captures,
                                                 double joint_px, const BuildOptions& options,
                                                 Progress& progress);

}  // namespace waymark
