#include "mapbuilder/upkeep/known_sizes.h"

#include <cmath>
#include <map>

namespace waymark {

MarkerCatalog with_sizes_of(const MarkerMap& map, const MarkerCatalog& catalog) {
  std::map<double, double> factors;
  for (const SubMap& submap : map.submaps) {
    for (const MapMarker& marker : submap.markers) {
      if (marker.size_m != marker.stated_size_m) {
        factors[marker.stated_size_m] = marker.size_m / marker.stated_size_m;
      }
    }
  }
  if (factors.empty()) return catalog;
  const auto corrected = [&](double stated_m) {
    const auto factor = factors.find(stated_m);
    return factor == factors.end() ? stated_m : stated_m * factor->second;
  };
  std::vector<MarkerCatalog::FamilyEntry> entries = catalog.entries();
  for (MarkerCatalog::FamilyEntry& entry : entries) {
    if (entry.default_size_m) entry.default_size_m = corrected(*entry.default_size_m);
    for (auto& [number, size_m] : entry.size_m_by_id) size_m = corrected(size_m);
  }
  // What a diagnosis has fitted is one marker's own.
  for (const SubMap& submap : map.submaps) {
    for (const MapMarker& marker : submap.markers) {
      if (catalog.size_m(marker.id) != marker.stated_size_m) continue;
      for (MarkerCatalog::FamilyEntry& entry : entries) {
        if (entry.family == marker.id.family) {
          entry.size_m_by_id[marker.id.number] = marker.size_m;
        }
      }
    }
  }
  return MarkerCatalog(std::move(entries));
}

}  // namespace waymark
