#pragma once

#include <vector>

#include "simulator/rig_library.h"
#include "simulator/visibility.h"

namespace waymark::simulator {

/// What a capture of a scene with a rig can know at best: which images see which markers, and
/// whether that ties everything together.
struct DetectionGraph {
  int images = 0;
  int empty_images = 0;
  int one_marker_images = 0;
  int observations = 0;
  int components = 0;  ///< of markers and nodes (frame sets; images for mono) that see at least one
  int unseen_markers = 0;
  int markers_seen_once = 0;  ///< by one node only
};

/// From geometry alone, standing at each of the scene's positions.
[[nodiscard]] DetectionGraph detection_graph(const Scene& scene, const SimulatedRig& rig,
                                             const VisibilityLimits& limits = {});

/// world_from_cam0 at the `count` positions of a scene's way.
[[nodiscard]] std::vector<Rigid3> standing_positions(const Scene& scene, int count);

/// world_from_rig when cam0 stands at `world_from_cam0`.
[[nodiscard]] inline Rigid3 world_from_rig(const Rig& rig, const Rigid3& world_from_cam0) {
  return world_from_cam0 * rig.cameras.front().rig_from_cam.inverse();
}

}  // namespace waymark::simulator
