#pragma once

#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/mapping/world_frame.h"

namespace waymark {

/// What moved, appeared and vanished against an earlier map, in that order.
[[nodiscard]] std::vector<Finding> frame_findings(const FrameComparison& comparison);

/// The earlier map and the new one share too few markers that agree.
[[nodiscard]] Finding frame_not_found();

}  // namespace waymark
