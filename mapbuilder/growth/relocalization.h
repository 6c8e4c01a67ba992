#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/map/marker_map.h"
#include "mapbuilder/growth/localized_frame_set.h"
#include "mapbuilder/growth/mapper_options.h"

namespace waymark {

/// A capture's frame sets against one sub-map.
struct RelocalizedSubMap {
  std::vector<LocalizedFrameSet> trajectory;  ///< unambiguous ones, by rising index
  std::vector<FrameSetIndex> ambiguous;       ///< the runner-up explains their data too
  std::size_t candidates = 0;  ///< frame sets that see at least two of the sub-map's markers
  std::size_t localized = 0;   ///< of these, with a pose in the trajectory
  double rms_px = 0;           ///< over the corners of accepted observations
  double rms_all_px = 0;       ///< over all observations of the sub-map's markers in localized sets
  std::size_t observations = 0;
  std::size_t rejected = 0;  ///< by the gate
  double model_sigma_px = 0;
};

/// Contribution 3 of the paper: every frame set localized against a finished map by Algorithm 1,
/// markers fixed, with the map's sizes. One result per sub-map, in the map's order.
[[nodiscard]] std::vector<RelocalizedSubMap> relocalize(const Observations& observations,
                                                        const MarkerMap& map,
                                                        const MapperOptions& options,
                                                        Progress& progress);

}  // namespace waymark
