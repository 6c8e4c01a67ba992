#pragma once

#include <optional>

#include "core/map/marker_map.h"

namespace waymark {

/// How far two markers' centres are apart, and how sure a map is of that; g is the unit vector from
/// one to the other. Sigmas are nullopt where a covariance is unknown, or the centres are one
/// point.
struct MarkerDistance {
  double distance_m = 0;
  /// One standard deviation within the map, the two markers taken as independent (a map's
  /// covariances are marginals): σ² = g W_i gᵀ + g W_j gᵀ.
  std::optional<double> sigma_m;
  /// The most that can be, however the two depend on each other: √(g W_i gᵀ) + √(g W_j gᵀ).
  std::optional<double> sigma_bound_m;
  /// One standard deviation against a metre outside, by what the map considers: σ² = g C_i gᵀ +
  /// g C_j gᵀ − 2 g T_i T_jᵀ gᵀ. Of a map that considers nothing that bound, where measured lengths
  /// gave the scale, whose error is within its covariances and alike for both markers, else
  /// nullopt: it does not hold how sure the stated sizes are.
  std::optional<double> sigma_metric_m;
};

/// Of two markers of one sub-map, whose frame is `frame`.
[[nodiscard]] MarkerDistance distance_between(const MapMarker& from, const MapMarker& to,
                                              FrameKind frame);

}  // namespace waymark
