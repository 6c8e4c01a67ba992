#pragma once

#include <vector>

#include "mapbuilder/diagnosis/map_evidence.h"
#include "mapbuilder/diagnosis/marker_places.h"
#include "mapbuilder/diagnosis/size_fit.h"
#include "mapbuilder/diagnosis/wrong_ids.h"

namespace waymark {

/// Options of the diagnosis of markers.
struct DiagnosisOptions {
  SizeOptions size;
  PlaceOptions places;
  WrongIdOptions wrong_ids;
};

/// An id that was seen at more than one place.
struct DisplacedMarker {
  int marker = 0;                    ///< table index
  std::vector<PlaceCluster> places;  ///< two or more, most views first
  PlaceHistory history;              ///< of the first two
  /// The place that the map keeps (index in places); nullopt: kept out of the map.
  std::optional<std::size_t> kept;
};

/// What is wrong with the markers of one sub-map. Sound ones are in none of the lists.
struct MarkerDiagnosis {
  std::vector<WrongSize> sizes;
  std::vector<DisplacedMarker> displaced;
  std::vector<WrongId> wrong_ids;
};

[[nodiscard]] MarkerDiagnosis diagnose_markers(const MapEvidence& evidence,
                                               const DiagnosisOptions& options);

}  // namespace waymark
