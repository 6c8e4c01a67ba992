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

/// Looks for what is wrong with lenses, rig file or clocks, from the simplest on, where a build
/// contradicts its observations: builds the map once more with every image on its own. Cameras that
/// do not fit alone are asked which intrinsics they fit (fit_camera_alone, explain_lens). Where
/// each image fits alone, where the cameras stood is held against the rig (explain_rig). What is
/// found is put right in the captures returned, or left out of them (a camera's images where its
/// time is wrong), so that the rest can be judged anew. No findings where no cause stands out.
/// `joint_px` is what the build of the captures as they are misses by (FitQuality).
[[nodiscard]] ExplainedCaptures explain_captures(const std::vector<DetectedCapture>& captures,
                                                 double joint_px, const BuildOptions& options,
                                                 Progress& progress);

}  // namespace waymark
