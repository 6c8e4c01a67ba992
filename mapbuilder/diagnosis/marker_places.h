#pragma once

#include <optional>
#include <span>
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
  /// (3–50) Views that must agree: two can by accident, when a wrong id is read twice.
  int least_views = 3;
  /// (0.5–30°) Directions they must be seen from: views from one spot agree on anything.
  double least_parallax_rad = 0.035;
  /// (0.05–2, of the marker's side) Nearer places are one: a bad calibration tears a place apart
  /// by as much as a tenth.
  double least_separation = 0.25;
};

/// All places that views of one id agree on, most views first; each view is in at most one. Found
/// one after the other by robust placement of what the places before leave over, within the gate.
[[nodiscard]] std::vector<PlaceCluster> find_places(const MapEvidence& evidence,
                                                    std::vector<MarkerView> views,
                                                    const PlaceOptions& options);

/// How a marker's second place came about.
enum class PlaceStory {
  twin,                   ///< seen at both places in turn, or nobody looked at the empty place
  moved_during_capture,   ///< first here, then there, and one of both was seen empty
  moved_between_captures  ///< here in some captures, there in others
};

struct PlaceHistory {
  PlaceStory story = PlaceStory::twin;
  /// Which of two places is the later one; nullopt: clocks don't tell.
  std::optional<bool> second_is_later;
  bool interleaved = false;  ///< seen at both places in turn
  int empty_looks = 0;  ///< frame sets that should have seen it where it no longer, or not yet, was
};

/// Tells from stamps, and from looks at the empty place, how an id comes to two places.
[[nodiscard]] PlaceHistory history_of(const MapEvidence& evidence, const PlaceCluster& first,
                                      const PlaceCluster& second);

}  // namespace waymark
