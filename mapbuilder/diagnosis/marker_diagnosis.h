#pragma once

#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"
#include "mapbuilder/diagnosis/marker_places.h"
#include "mapbuilder/diagnosis/misshapen_markers.h"
#include "mapbuilder/diagnosis/moving_markers.h"
#include "mapbuilder/diagnosis/place_history.h"
#include "mapbuilder/diagnosis/presence.h"
#include "mapbuilder/diagnosis/wrong_ids.h"
#include "mapbuilder/diagnosis/wrong_sizes.h"

namespace waymark {

/// Options of the diagnosis of markers.
struct DiagnosisOptions {
  OddPrintOptions prints;
  PlaceOptions places;
  HistoryOptions history;
  WrongIdOptions wrong_ids;
  PresenceOptions presence;
  MovementOptions movement;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// An id that was seen at more than one place.
struct DisplacedMarker {
  MarkerIndex marker;
  std::vector<PlaceCluster> places;  ///< two or more, most views first
  PlaceHistory history;              ///< of the first two
  /// The place that the map keeps (index in places); nullopt: kept out of the map.
  std::optional<std::size_t> kept;
};

/// What is wrong with the markers of one component. Sound ones are in none of the lists.
struct MarkerDiagnosis {
  std::vector<MisshapenMarker> misshapen;
  std::vector<WrongSize> sizes;
  std::vector<DisplacedMarker> displaced;
  std::vector<RidingMarker> riding;
  std::vector<RestlessMarker> restless;
  std::vector<MovingGroup> groups;
  /// Each shows another marker of the map, or what put its marker there against most views.
  std::vector<WrongId> wrong_ids;
  /// Rejected detections that show no marker of the map, and markers that come or go: what is left
  /// to say when nothing else is wrong, and may have another reason when something is.
  std::vector<WrongId> strays;
  std::vector<PartTimeMarker> part_time;
};

/// Looks at what contradicts the map: observations that the gate rejects, ids found twice in one
/// image, ids that stand on other markers, and sizes.
[[nodiscard]] MarkerDiagnosis diagnose_markers(const MapEvidence& evidence,
                                               const DiagnosisOptions& options);

}  // namespace waymark
