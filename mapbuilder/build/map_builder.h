#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/map/marker_map.h"
#include "mapbuilder/build/built_submap.h"
#include "mapbuilder/calibration/calibration.h"
#include "mapbuilder/growth/build_options.h"

namespace waymark {

/// What a build gives.
struct BuildResult {
  MarkerMap map;
  std::vector<BuiltSubMap> submaps;  ///< in the map's order
  std::vector<MarkerId> unmapped;    ///< seen, but no pose could be trusted
  std::vector<int> unlocalized;      ///< frame sets with observations but without a pose
  std::vector<int> without_markers;  ///< frame sets without a usable observation
  CalibrationResult calibration;     ///< of all sub-maps: there is one rig file and one survey
};

/// Builds the map of all captures in the table: components, growth (Algorithm 2), joint adjustment
/// (eq. 11), reconsideration of flips, outlier gate, survey and refinement, covariances. Parts that
/// share no marker are sub-maps, but for those that the survey fixes in its own frame: these are
/// one. Overwrites the table's whitening.
[[nodiscard]] BuildResult build_map(ObservationTable& table, const BuildOptions& options,
                                    Progress& progress);

}  // namespace waymark
