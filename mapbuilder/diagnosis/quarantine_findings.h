#pragma once

#include <set>
#include <vector>

#include "core/map/quarantine.h"
#include "mapbuilder/build/frame_comparison.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// Those that the vehicle took for moved: they must not carry a frame.
[[nodiscard]] std::set<MarkerId> moved_markers(const Quarantine& quarantine);

/// What a build tells of the markers in a vehicle's quarantine: moved indeed (beside what
/// frame_findings says of them), standing where they stood, unknown then and mapped now, or open.
/// `comparison` is that with the map the quarantine belongs to; null: there is none.
[[nodiscard]] std::vector<Finding> quarantine_findings(const Quarantine& quarantine,
                                                       const BuildResult& result,
                                                       const FrameComparison* comparison,
                                                       bool with_family);

}  // namespace waymark
