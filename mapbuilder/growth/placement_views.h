#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/bundle/prepared_observations.h"
#include "mapbuilder/growth/mapper_options.h"

namespace waymark {

/// Which localized frame sets may place a marker.
using FrameSetFilter = std::function<bool(FrameSetIndex)>;

/// At most `most` accepted views of the marker by localized frame sets that the filter takes; of
/// all its views where none is accepted.
[[nodiscard]] std::vector<PlacementView> placement_views(const PreparedObservations& prepared,
                                                         const Estimate& estimate,
                                                         MarkerIndex marker, std::size_t most,
                                                         const FrameSetFilter& filter);

/// Where each of the markers stands by these views; nullopt: they don't tell.
[[nodiscard]] std::vector<std::optional<PlacementEstimate>> place_markers(
    const PreparedObservations& prepared, const Estimate& estimate,
    std::span<const MarkerIndex> markers, const FrameSetFilter& filter,
    const MapperOptions& options);

}  // namespace waymark
