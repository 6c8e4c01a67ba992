#include "locd/pose/map_index.h"

#include <algorithm>
#include <map>

#include "core/base/check.h"
#include "core/estimate/calibration_prior.h"

namespace waymark {

MapIndex::MapIndex(const MarkerMap& map) {
  WAYMARK_CHECK(!map.submaps.empty());
  submap_ = map.submaps.front();
  rig_fingerprint_ = map.rig_fingerprint;
  independent_ = map.capture_fingerprints.empty() ||
                 std::all_of(submap_.markers.begin(), submap_.markers.end(),
                             [](const MapMarker& marker) { return marker.considered(); });
  quarantined_.assign(size(), 0);
  for (MapMarker& marker : submap_.markers) {
    if (marker.metric().allFinite()) continue;
    ++unknown_covariances_;
    marker.covariance.setZero();
    marker.covariance.diagonal().head<3>().setConstant(kUnknownSigma_m * kUnknownSigma_m);
    marker.covariance.diagonal().tail<3>().setConstant(kUnknownSigma_rad * kUnknownSigma_rad);
    marker.modes.setZero();
  }
  own_.reserve(size());
  for (const MapMarker& marker : submap_.markers) own_.push_back(marker.own_covariance());
}

bool MapIndex::calibrated_with(const Rig& rig) const {
  return is_calibration_of(submap_, rig_fingerprint_, rig);
}

std::optional<std::size_t> MapIndex::find(const MarkerId& id) const {
  const std::vector<MapMarker>& markers = submap_.markers;
  const auto found = std::lower_bound(
      markers.begin(), markers.end(), id,
      [](const MapMarker& marker, const MarkerId& wanted) { return marker.id < wanted; });
  if (found == markers.end() || found->id != id) return std::nullopt;
  return static_cast<std::size_t>(found - markers.begin());
}

MarkerCatalog MapIndex::catalog(std::span<const Family> inverted) const {
  std::map<Family, std::map<double, int>> sizes;
  std::map<Family, MarkerCatalog::FamilyEntry> entries;
  for (const MapMarker& marker : submap_.markers) {
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
