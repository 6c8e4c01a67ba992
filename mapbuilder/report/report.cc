#include "mapbuilder/report/report.h"

#include <set>

namespace waymark {

bool Report::several_families() const {
  std::set<Family> families;
  for (const SubMap& submap : map.submaps) {
    for (const MapMarker& marker : submap.markers) families.insert(marker.id.family);
  }
  for (const MarkerId& id : unmapped) families.insert(id.family);
  for (const Finding& finding : findings) {
    for (const MarkerId& id : finding.markers) families.insert(id.family);
  }
  return families.size() > 1;
}

}  // namespace waymark
