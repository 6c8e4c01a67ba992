#pragma once

#include <span>
#include <vector>

#include "core/marker/marker_geometry.h"

namespace waymark {

/// A marker's corners as found, and as projected from the truth (px).
struct CornerPair {
  ImageCorners found;
  ImageCorners truth;
};

/// How far found corners lie off.
struct CornerAccuracy {
  double edge_bias_px = 0;  ///< mean over all edges of how far outside the true edge they lie
  double sigma_px = 0;      ///< per axis, of what the edge bias leaves
  double rms_px = 0;        ///< √ of the mean squared 2-vector, bias included
};

/// Corners of the true quadrangle with each of its four edges moved outwards by `offset_px`.
[[nodiscard]] ImageCorners with_edges_moved(const ImageCorners& truth, double offset_px);

/// How far (px) the four edges lie outside the true ones on average: each is taken at its two
/// corners along the true edge's normal, and counts by its length, so that a shift of the whole
/// marker is none.
[[nodiscard]] double edge_offset_px(const CornerPair& marker);

/// All zero without markers.
[[nodiscard]] CornerAccuracy corner_accuracy(std::span<const CornerPair> markers);

}  // namespace waymark
