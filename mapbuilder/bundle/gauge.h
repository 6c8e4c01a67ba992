#pragma once

#include <span>

#include "mapbuilder/bundle/bundle_problem.h"

namespace waymark {

/// The constant poses with which every place is determined: the problem's own and, of every
/// connected component of the given accepted observations in which no pose is constant and none
/// stands in the survey's frame (the outlier gate can cut a map in two), the first frame set.
[[nodiscard]] ConstantPoses fix_gauge(const BundleProblem& problem,
                                      std::span<const ObservationIndex> observations,
                                      const Estimate& estimate);

}  // namespace waymark
