#pragma once

#include <span>

#include "mapbuilder/bundle/joint_problem.h"

namespace waymark {

struct AdjustmentScope;

/// What has to stand still so that every place is determined: `held` and, of every piece of the
/// given accepted observations that nothing of it ties to a held pose or to the survey's frame
/// (the outlier gate can cut a map in two), the first frame set.
[[nodiscard]] HeldPoses hold_free_pieces(const ObservationTable& table,
                                         const std::vector<std::size_t>& observations,
                                         const AdjustmentScope& scope, const MapState& state,
                                         const HeldPoses& held);

}  // namespace waymark
