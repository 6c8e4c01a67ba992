#pragma once

#include <optional>
#include <vector>

#include "core/map/marker_map.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// The markers that locd localizes by: those of a map's first sub-map, the largest, for a pose is
/// of one frame. Found by id; which of them are quarantined is noted here.
class MapIndex {
 public:
  explicit MapIndex(const MarkerMap& map);

  [[nodiscard]] std::size_t size() const { return markers_.size(); }
  [[nodiscard]] const MapMarker& marker(std::size_t index) const { return markers_[index]; }
  [[nodiscard]] std::optional<std::size_t> find(const MarkerId& id) const;

  [[nodiscard]] bool quarantined(std::size_t index) const { return quarantined_[index] != 0; }
  void set_quarantined(std::size_t index, bool value) { quarantined_[index] = value ? 1 : 0; }

  /// What detectors look for: the map's families. Ids that the map lacks are taken too, with the
  /// family's most frequent size, so that a marker nobody mapped can be named.
  [[nodiscard]] MarkerCatalog catalog() const;

 private:
  std::vector<MapMarker> markers_;  ///< by rising id
  std::vector<char> quarantined_;
};

}  // namespace waymark
