#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/camera/rig.h"
#include "core/map/marker_map.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// The markers that locd localizes by: those of a map's first sub-map, the largest, for a pose is
/// of one frame. Found by id; which of them are quarantined is noted here. A marker whose
/// covariance the map does not know stands there as if it were known to kUnknownSigma only, so that
/// what rests on it is never OK.
class MapIndex {
 public:
  /// No useful map is worse. (0.01–1 m, 0.01–1 rad)
  static constexpr double kUnknownSigma_m = 0.1;
  static constexpr double kUnknownSigma_rad = 0.1;

  explicit MapIndex(const MarkerMap& map);

  [[nodiscard]] std::size_t size() const { return submap_.markers.size(); }
  /// Markers whose covariance the map does not know.
  [[nodiscard]] std::size_t unknown_covariances() const { return unknown_covariances_; }
  [[nodiscard]] const MapMarker& marker(std::size_t index) const { return submap_.markers[index]; }
  [[nodiscard]] std::optional<std::size_t> find(const MarkerId& id) const;

  /// What a marker's pose errs by and no other marker does (MapMarker::own_covariance).
  [[nodiscard]] const Matrix6d& own_covariance(std::size_t index) const { return own_[index]; }
  /// Them all, with what they share.
  [[nodiscard]] const SubMap& submap() const { return submap_; }
  /// Whether the map was built with this rig's calibration (is_calibration_of).
  [[nodiscard]] bool calibrated_with(const Rig& rig) const;

  /// Whether own_covariance is wrong independently of each other: the map was measured by hand, or
  /// says what its markers share. Of an older map made from captures, neighbours are wrong alike.
  [[nodiscard]] bool independent() const { return independent_; }

  [[nodiscard]] bool quarantined(std::size_t index) const { return quarantined_[index] != 0; }
  void set_quarantined(std::size_t index, bool value) { quarantined_[index] = value ? 1 : 0; }

  /// What detectors look for: the map's families, some of them `inverted` (printed white for
  /// black). Ids that the map lacks are taken too, with the family's most frequent size, so that a
  /// marker nobody mapped can be named.
  [[nodiscard]] MarkerCatalog catalog(std::span<const Family> inverted = {}) const;

 private:
  SubMap submap_;
  std::string rig_fingerprint_;
  std::vector<Matrix6d> own_;
  std::vector<char> quarantined_;
  std::size_t unknown_covariances_ = 0;
  bool independent_ = true;
};

/// Those of a catalog that are printed white for black.
[[nodiscard]] std::vector<Family> inverted_families(const MarkerCatalog& catalog);

}  // namespace waymark
