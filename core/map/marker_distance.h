#pragma once

#include <optional>

#include "core/map/marker_map.h"

namespace waymark {

/// How far two markers' centres are apart, and how sure a map is of that.
struct MarkerDistance {
  double distance_m = 0;
  /// One standard deviation within the map, the two markers taken as independent (a map's
  /// covariances are marginals): σ² = g C_i gᵀ + g C_j gᵀ, g the unit vector from one to the other.
  /// nullopt where a covariance is unknown, or the centres are one point.
  std::optional<double> sigma_m;
  /// The most it can be, however the two depend on each other: √(g C_i gᵀ) + √(g C_j gᵀ).
  std::optional<double> sigma_bound_m;
  /// One standard deviation against a metre outside, at most: that bound where measured lengths
  /// gave the scale, whose error is within the map's covariances and alike for both markers.
  /// nullopt where the scale rests on stated sizes: the map does not hold how sure that is.
  std::optional<double> sigma_metric_m;
};

/// Of two markers of one sub-map, whose frame is `frame`.
[[nodiscard]] MarkerDistance distance_between(const MapMarker& from, const MapMarker& to,
                                              FrameKind frame);

}  // namespace waymark
