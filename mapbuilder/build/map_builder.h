#pragma once

#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/map/marker_map.h"
#include "mapbuilder/build/build_options.h"
#include "mapbuilder/build/built_submap.h"

namespace waymark {

/// What a build gives.
struct BuildResult {
  MarkerMap map;
  std::vector<BuiltSubMap> submaps;            ///< in the map's order
  std::vector<MarkerId> unmapped;              ///< seen, but no pose could be trusted
  std::vector<FrameSetIndex> unlocalized;      ///< with observations but without a pose
  std::vector<FrameSetIndex> without_markers;  ///< without a usable observation
  CalibrationResult calibration;  ///< of all sub-maps: there is one rig file and one survey
  Estimate estimate;              ///< that the map was made of
  bool given_up = false;  ///< GrowthOptions::give_up_sigma_px: then nothing else means anything

  /// What explains the images best, by which single detections are judged: the map's estimate or,
  /// where the rig file does not fit, that of a rig which was variable for a few steps.
  [[nodiscard]] const Estimate& evidence() const {
    return calibration.examined ? *calibration.examined : estimate;
  }
};

/// Builds the map of what is selected: components, growth (Algorithm 2), joint adjustment (eq. 11),
/// reconsideration of flips, outlier gate, survey and refinement, covariances. What shares no
/// marker is a sub-map each, but for what the survey fixes in its own frame: that is one. A marker
/// seen once and alone is none, unless there is nothing else. `start`: the estimate that a build
/// without refinement and survey has made of the same observations by other sizes; growth goes on
/// from it, with the markers of changed size to be placed anew.
[[nodiscard]] BuildResult build_map(const Selection& selection, const BuildOptions& options,
                                    Progress& progress, std::optional<Estimate> start = {});

}  // namespace waymark
