#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulator/scene.h"

namespace waymark::simulator {

/// Boxes and free-standing walls that come near a place; in a large building few of all. They point
/// into the scene, which must outlive them.
struct Occluders {
  std::vector<const Box*> boxes;
  std::vector<const Surface*> walls;
};

/// Those that come within `range_m` (horizontally, along each axis) of a point.
[[nodiscard]] Occluders occluders_near(const Scene& scene, const Eigen::Vector3d& point_m,
                                       double range_m);

/// Whether one of them stands between two points inside the room.
[[nodiscard]] bool is_occluded(const Occluders& occluders, const Eigen::Vector3d& from_m,
                               const Eigen::Vector3d& to_m);

/// Distance (m) from a point in the room to the nearest wall, box, floor or ceiling; negative
/// outside the room and inside a box.
[[nodiscard]] double clearance_m(const Scene& scene, const Eigen::Vector3d& point_m);

}  // namespace waymark::simulator
