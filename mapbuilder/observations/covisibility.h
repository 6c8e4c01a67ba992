#pragma once

#include <span>
#include <vector>

#include "mapbuilder/observations/selection.h"

namespace waymark {

/// Connected components of the graph frame sets – markers over the given observations, by falling
/// marker count, then first marker. Markers and frame sets that none of them touches are in none.
[[nodiscard]] std::vector<Component> connected_components(const Observations& observations,
                                                          std::span<const ObservationIndex> edges);

/// The frame set to start from (paper §III-F.1: the one with most markers); ties go to the larger
/// markers in the image, so that neither stamps nor order decide.
[[nodiscard]] FrameSetIndex choose_seed(const Selection& selection, const Component& component);

}  // namespace waymark
