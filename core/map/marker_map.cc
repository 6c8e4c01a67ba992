#include "core/map/marker_map.h"

#include <limits>

namespace waymark {

Matrix6d unknown_covariance() {
  return Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN());
}

bool MapMarker::covariance_known() const { return covariance.allFinite(); }

MeetingFamilies MarkerMap::families() const {
  MeetingFamilies families;
  for (const SubMap& submap : submaps) {
    for (const MapMarker& marker : submap.markers) families.add(marker.id.family);
  }
  return families;
}

}  // namespace waymark
