#pragma once

#include <vector>

#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// What moved, appeared and vanished against an earlier map, in that order.
[[nodiscard]] std::vector<Finding> frame_findings(const FrameComparison& comparison);

/// The earlier map and the new one share too few markers that agree.
[[nodiscard]] Finding frame_not_found();

}  // namespace waymark
