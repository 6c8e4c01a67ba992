#pragma once

#include "mapbuilder/bundle/reduced_problem.h"

namespace waymark {

/// How much a map grows (relative) per pixel by which a camera's edges are seen further out than
/// they are. Blooming, print and sensor response shift edges so, and without a measured length
/// nothing tells: the map's scale is only as good. To first order at the estimate's poses, over the
/// accepted ones of the given observations, whose markers stand in one world with the frame set
/// `anchor`. Empty when they don't fix all markers against each other, or are of one marker.
[[nodiscard]] IndexedVector<CameraIndex, double> scale_per_edge_px(
    const PreparedObservations& prepared, const Estimate& estimate,
    std::span<const ObservationIndex> observations, FrameSetIndex anchor,
    const ObservationLoss& loss, int threads);

}  // namespace waymark
