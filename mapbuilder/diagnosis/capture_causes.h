#pragma once

#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/lens_evidence.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// Captures with what keeps their cameras from fitting together put right, or left out.
struct ExplainedCaptures {
  std::vector<DetectedCapture> captures;
  std::vector<Finding> findings;  ///< one per cause, errors
  /// Cameras that merely stand elsewhere: not put right, for a build's own calibration tells most
  /// of them, and their places better.
  struct Displaced {
    std::size_t capture = 0;  ///< place among the captures
    Rig rig;                  ///< that explains the images
    Finding finding;
  };
  std::vector<Displaced> displaced;
};

/// What a build of the captures as stated has come to.
struct StatedBuild {
  const Observations& observations;
  const BuildResult& result;
  double joint_px = 0;  ///< FitQuality
};

/// Looks for what is wrong with prints, lenses, rig file or clocks, from the simplest on, where a
/// build contradicts its observations, or markers' own outlines contradict the lenses
/// (`lenses`, of telling_images; then `build` may be null). Cheap tests lead: outlines tell whether
/// prints are square (fit_print_shape) and lenses another camera's (judge_lens); one mono build
/// with what they tell is examined for what is left of the lenses, and by it all images say where
/// their cameras stood, which is held against the rig (explain_rig); what of the lenses that does
/// not explain is told (correct_lenses). What is found is put right in the captures returned, or
/// left out of them (a camera's images where its time is wrong), so that the rest can be judged
/// anew. No findings where no cause stands out.
[[nodiscard]] ExplainedCaptures explain_captures(const std::vector<DetectedCapture>& captures,
                                                 const LensesBySquares& lenses,
                                                 const StatedBuild* build,
                                                 const BuildOptions& options);

}  // namespace waymark
