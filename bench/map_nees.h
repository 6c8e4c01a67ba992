#pragma once

#include <map>

#include "core/map/marker_map.h"

namespace waymark::bench {

/// A map's errors against what it states, per degree of freedom: 1 where sigmas hold.
struct MapNees {
  double markers = 0;  ///< mean of each marker's own, by its metric covariance
  double joint = 0;    ///< of all together, by D + T Tᵀ
  double within = 0;   ///< mean by the covariances within the map
  double error_m = 0;  ///< RMS of positions
  double sigma_m = 0;  ///< RMS of metric sigmas of positions
};

/// Of a map whose markers are all in `truth`, aligned on their positions, as its gauge is.
[[nodiscard]] MapNees map_nees(const SubMap& map, const std::map<MarkerId, Rigid3>& truth);

}  // namespace waymark::bench
