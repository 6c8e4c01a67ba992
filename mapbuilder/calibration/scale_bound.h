#pragma once

#include <span>
#include <vector>

#include "mapbuilder/growth/joint_build.h"

namespace waymark {

/// How much a map grows (relative) per pixel by which a camera's edges are seen further out than
/// they are: per camera of all rigs. Blooming, print and sensor response shift edges so, and
/// without a measured length nothing tells: the map's scale is only as good. To first order at the
/// build's poses, over the accepted ones of the given observations, whose markers stand in one
/// world with the frame set `anchor`. Empty when they don't fix all markers against each other, or
/// are of one marker.
[[nodiscard]] std::vector<double> scale_per_edge_px(const JointBuild& build,
                                                    std::span<const std::size_t> observations,
                                                    int anchor);

}  // namespace waymark
