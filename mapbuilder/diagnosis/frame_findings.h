#pragma once

#include <filesystem>
#include <vector>

#include "mapbuilder/build/frame_comparison.h"
#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// What moved, appeared and vanished against an earlier map, in that order.
[[nodiscard]] std::vector<Finding> frame_findings(const FrameComparison& comparison,
                                                  bool with_family);

/// The earlier map and the new one share too few markers that agree.
[[nodiscard]] Finding frame_not_found(const std::filesystem::path& earlier);

/// A sub-map that keeps its own axes: nothing tells where up is.
[[nodiscard]] Finding not_levelled(std::size_t submap, std::size_t markers, LevelBy by);

}  // namespace waymark
