#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/estimate/marker_observation.h"

namespace waymark {

/// An observation of the marker to be placed, by a rig whose pose is known, perhaps up to an
/// ambiguity.
struct PlacementView {
  const MarkerObservation* observation = nullptr;
  const CameraModel* camera = nullptr;
  Rigid3 cam_from_rig;
  Rigid3 world_from_rig;
  std::optional<Rigid3> other_world_from_rig;  ///< the rig's runner-up, when its pose is ambiguous
};

/// Options of placing a marker. Sigmas as in RigPoseOptions.
struct PlacementOptions {
  ObservationLoss loss;
  double score_scale_sigmas = 20.0;  ///< (5–100)
  int max_refined = 4;               ///< (2–50)
  int max_iterations = 30;           ///< (1–200)
  double distinct_rad = 0.035;       ///< (0.002–0.5)
  double distinct_m = 0.05;          ///< (0.001–1)

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Where a marker can stand.
struct PlacementEstimate {
  PoseOptimum best;                      ///< world_from_marker
  std::optional<PoseOptimum> runner_up;  ///< the best distinct one, the flipped one as a rule
  /// Score by which the runner-up is worse (sigmas²); infinite without one.
  double gap = std::numeric_limits<double>::infinity();
};

/// Places a marker (paper §III-F.3) by all its views at once: both IPPE solutions of every view (by
/// every possible pose of the rig) are scored on all views, the best refined with the rigs fixed.
/// nullopt when no view has an IPPE solution or none can be refined.
[[nodiscard]] std::optional<PlacementEstimate> place_marker(std::span<const PlacementView> views,
                                                            const PlacementOptions& options);

/// How ill a marker's pose suits its views, each with the rig pose that suits it better:
/// Σ k² log(1 + s/k²), sigmas².
[[nodiscard]] double placement_score(std::span<const PlacementView> views,
                                     const Rigid3& world_from_marker,
                                     const PlacementOptions& options);

}  // namespace waymark
