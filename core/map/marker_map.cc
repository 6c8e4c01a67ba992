#include "core/map/marker_map.h"

namespace waymark {

MeetingFamilies MarkerMap::families() const {
  MeetingFamilies families;
  for (const SubMap& submap : submaps) {
    for (const MapMarker& marker : submap.markers) families.add(marker.id.family);
  }
  return families;
}

}  // namespace waymark
