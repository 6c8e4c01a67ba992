#pragma once

#include <optional>
#include <span>

#include "mapbuilder/diagnosis/map_evidence.h"
#include "mapbuilder/growth/marker_placement.h"

namespace waymark {

/// Places a marker by views whose cameras are known, as if its size were `factor` times the stated
/// one. At most 48 views, evenly spread, take part. nullopt as place_marker.
[[nodiscard]] std::optional<PlacementEstimate> place_at_size(std::span<const MarkerView> views,
                                                             double factor,
                                                             const MapperOptions& options);

/// Local optimum of a marker's pose from one start, likewise, at its stated size.
[[nodiscard]] std::optional<PoseOptimum> refine_place(std::span<const MarkerView> views,
                                                      const Rigid3& start,
                                                      const MapperOptions& options);

}  // namespace waymark
