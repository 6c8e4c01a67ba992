#pragma once

#include <string>
#include <vector>

#include "core/camera/rig.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/report/report.h"

namespace waymark {

/// A capture's true poses, as far as they are known.
struct CaptureTruth {
  std::string capture;  ///< its name among the observations
  Rig rig;
  std::vector<StampedPose> world_from_rig;  ///< in a world of its own, by rising stamp
};

/// What a build has to tell, for a report: sub-maps, tracks beside the truth (aligned per capture
/// and sub-map, SE(3) without scale), residuals. Survey and findings are left empty.
[[nodiscard]] Report report_of_build(const BuildResult& result, const Observations& observations,
                                     const std::vector<CaptureTruth>& truths);

}  // namespace waymark
