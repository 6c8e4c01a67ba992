#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"

namespace waymark {

/// Views that agree on where a marker stands.
struct PlaceCluster {
  SizedPlace place;
  std::vector<MarkerView> views;
  double sigma_m = 0;  ///< of the centre, largest axis; grows with the misfit of the views
};

/// What is to count as a place.
struct PlaceOptions {
  /// (3–50) Frame sets that must agree: two can by accident, when a wrong id is read twice.
  int least_views = 3;
  /// (0.008–0.5) Directions they must be seen from: views from one spot agree on anything.
  double least_parallax_rad = 0.015;
  /// (0.05–2, of the marker's side) Nearer places are one, unless the marker is turned by
  double least_separation = 0.25;
  double least_turn_rad = 0.35;  ///< (0.1–1.5) this: more than a flip of weak views

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// All places that views of one id agree on, most views first; each view is in at most one. Found
/// one after the other by robust placement of what the places before leave over, within the gate.
[[nodiscard]] std::vector<PlaceCluster> find_places(const MapEvidence& evidence,
                                                    std::vector<MarkerView> views,
                                                    const PlaceOptions& options);

}  // namespace waymark
