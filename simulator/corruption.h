#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "simulator/capture_plan.h"
#include "simulator/scene.h"
#include "simulator/simulate_detections.h"
#include "simulator/visibility.h"

namespace waymark::simulator {

/// Markers that do not hang, once and for all, where and how large they are said to.
struct Corruption {
  struct Twin {
    std::size_t marker;   ///< index into the scene's markers
    PlacedMarker second;  ///< the same id elsewhere
  };
  struct Move {
    std::size_t marker;
    Rigid3 world_from_marker_after;
    std::size_t from_position;  ///< the first frame set after the move
  };
  struct MisSize {
    std::size_t marker;
    double true_size_m;
  };
  std::vector<Twin> twins;
  std::vector<Move> moves;
  std::vector<MisSize> mis_sizes;

  /// The building as it is before and after the moves, with the twins and the true sizes.
  [[nodiscard]] Scene scene_before(const Scene& scene) const;
  [[nodiscard]] Scene scene_after(const Scene& scene) const;
};

/// Draws different markers for each kind among those that the plan sees at least four times (before
/// and after the middle, for moves); twins hang at least 2 m from each other. usage when there are
/// not enough.
[[nodiscard]] Expected<Corruption> draw_corruption(const Scene& scene, const SimulatedRig& rig,
                                                   const CapturePlan& plan,
                                                   const DetectionsJob& job);

/// An id read wrongly.
struct FalseId {
  Exposure exposure;
  MarkerId truth;
  MarkerId read;
};

/// groundtruth/corruptions.json: what a robust mapper should find, by id.
[[nodiscard]] std::string format_corruptions(const Scene& scene, const SimulatedRig& rig,
                                             const CapturePlan& plan, const Corruption& corruption,
                                             const std::vector<FalseId>& false_ids,
                                             const std::vector<Exposure>& dropped_images);

}  // namespace waymark::simulator
