#pragma once

#include <vector>

#include "core/estimate/marker_observation.h"
#include "mapbuilder/build/map_builder.h"

namespace waymark {

/// What a capture's images say of a marker's orientation: small markers look nearly alike when they
/// are flipped about the line of sight, and an estimate may have chosen either.
class TurnEvidence {
 public:
  /// Both must outlive it.
  TurnEvidence(const Observations& observations, const Estimate& estimate)
      : observations_(observations), estimate_(estimate) {}

  /// Whether the images speak against a marker that is turned by `turn` (about its own axes) from
  /// where the estimate has it, the cameras held: there is no optimum near by, or 2 Δ ln L against
  /// the estimate's pose is more than five sigmas make, the noise being what either leaves. False
  /// where too little is seen.
  [[nodiscard]] bool contradicts(MarkerId marker, const Eigen::Quaterniond& turn) const;

  /// An observation of the marker by a camera whose pose is known.
  struct Sight {
    MarkerObservation observation;
    ObservationGeometry geometry;
  };

 private:
  [[nodiscard]] std::vector<Sight> sights_of(MarkerIndex marker) const;

  const Observations& observations_;
  const Estimate& estimate_;
};

}  // namespace waymark
