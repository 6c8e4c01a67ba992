#include "locd/pose/map_index.h"

#include <algorithm>
#include <map>

#include "core/base/check.h"

namespace waymark {

MapIndex::MapIndex(const MarkerMap& map) {
  WAYMARK_CHECK(!map.submaps.empty());
  markers_ = map.submaps.front().markers;
  independent_ = map.capture_fingerprints.empty();
  quarantined_.assign(markers_.size(), 0);
  for (MapMarker& marker : markers_) {
    if (marker.covariance_known()) continue;
    ++unknown_covariances_;
    marker.covariance.setZero();
    marker.covariance.diagonal().head<3>().setConstant(kUnknownSigma_m * kUnknownSigma_m);
    marker.covariance.diagonal().tail<3>().setConstant(kUnknownSigma_rad * kUnknownSigma_rad);
  }
}

std::optional<std::size_t> MapIndex::find(const MarkerId& id) const {
  const auto found = std::lower_bound(
      markers_.begin(), markers_.end(), id,
      [](const MapMarker& marker, const MarkerId& wanted) { return marker.id < wanted; });
  if (found == markers_.end() || found->id != id) return std::nullopt;
  return static_cast<std::size_t>(found - markers_.begin());
}

MarkerCatalog MapIndex::catalog(std::span<const Family> inverted) const {
  std::map<Family, std::map<double, int>> sizes;
  std::map<Family, MarkerCatalog::FamilyEntry> entries;
  for (const MapMarker& marker : markers_) {
    ++sizes[marker.id.family][marker.size_m];
    MarkerCatalog::FamilyEntry& entry = entries[marker.id.family];
    entry.family = marker.id.family;
    entry.size_m_by_id[marker.id.number] = marker.size_m;
  }
  std::vector<MarkerCatalog::FamilyEntry> list;
  for (auto& [family, entry] : entries) {
    const auto& counted = sizes[family];
    entry.default_size_m =
        std::max_element(counted.begin(), counted.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        })->first;
    entry.inverted = std::find(inverted.begin(), inverted.end(), family) != inverted.end();
    list.push_back(std::move(entry));
  }
  return MarkerCatalog(std::move(list));
}

std::vector<Family> inverted_families(const MarkerCatalog& catalog) {
  std::vector<Family> families;
  for (const auto& entry : catalog.entries()) {
    if (entry.inverted) families.push_back(entry.family);
  }
  return families;
}

}  // namespace waymark
