#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/map/marker_map.h"

namespace waymark {

/// What somebody who knows the building changes by hand. All ids are those before the edit.
struct MapEdit {
  std::vector<MarkerId> remove;
  /// From, to: all at once, so that two may change places.
  std::vector<std::pair<MarkerId, MarkerId>> rename;
  /// Markers that the map holds as not verified (one view, which nothing confirms), and that
  /// somebody has looked at: they count as verified from then on, as those measured by hand do.
  /// Place and covariance stay.
  std::vector<MarkerId> accept;

  [[nodiscard]] bool empty() const { return remove.empty() && rename.empty() && accept.empty(); }
};

/// The map with the edit made: markers and sub-maps sorted anew, sub-maps left without a marker
/// gone. What was computed of all markers together (RMS, frame sets, the gauge of the covariances)
/// stays that of the build. `name` stands for the map's path. Errors: usage for an edit that
/// contradicts itself (a marker removed and kept, renamed twice, to itself, or to another family,
/// whose prints have another upright and size); bad_data for ids that the map lacks, for two
/// markers of one id, and where no marker would be left.
[[nodiscard]] Expected<MarkerMap> edit_map(const MarkerMap& map, const std::string& name,
                                           const MapEdit& edit);

/// Sorts markers by id and sub-maps as a map holds them.
void sort_map(MarkerMap& map);

}  // namespace waymark
