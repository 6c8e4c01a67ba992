#include "core/map/marker_map.h"

namespace waymark {

bool MarkerMap::several_families() const {
  const MapMarker* first = nullptr;
  for (const SubMap& submap : submaps) {
    for (const MapMarker& marker : submap.markers) {
      if (first == nullptr) first = &marker;
      if (marker.id.family != first->id.family) return true;
    }
  }
  return false;
}

}  // namespace waymark
