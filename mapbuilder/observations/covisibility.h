#pragma once

#include <vector>

#include "mapbuilder/observations/observation_table.h"

namespace waymark {

/// Frame sets and markers that hang together by observations; all indices rising.
struct Component {
  std::vector<int> frame_sets;
  std::vector<int> markers;
};

/// Connected components of the graph frame sets – markers over the observations with `used[i]` ≠ 0,
/// by falling marker count, then first marker. Markers and frame sets without a used observation
/// are in none.
[[nodiscard]] std::vector<Component> connected_components(const ObservationTable& table,
                                                          const std::vector<char>& used);

/// The frame set to start from (paper §III-F.1: the one with most markers); ties go to the larger
/// markers in the image, so that neither stamps nor order decide.
[[nodiscard]] int choose_seed(const ObservationTable& table, const Component& component);

}  // namespace waymark
