#pragma once

#include <set>
#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// What a build itself knows to be wrong or weak: parts that share no markers, an adjustment that
/// did not come to rest, unknown covariances, corners far off, markers of one view, markers and
/// frame sets without a pose, ids found twice in one image, corners of no square, frame sets
/// without markers. In that order. Markers that are `explained` need no pose.
[[nodiscard]] std::vector<Finding> build_findings(const BuildResult& result,
                                                  const Observations& observations,
                                                  const std::set<MarkerId>& explained = {});

}  // namespace waymark
