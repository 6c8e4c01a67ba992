#pragma once

#include <Eigen/Core>

#include "simulator/scene.h"

namespace waymark::simulator {

/// Whether a box or a free-standing wall stands between two points inside the room.
[[nodiscard]] bool is_occluded(const Scene& scene, const Eigen::Vector3d& from_m,
                               const Eigen::Vector3d& to_m);

/// Distance (m) from a point in the room to the nearest wall, box, floor or ceiling; negative
/// outside the room and inside a box.
[[nodiscard]] double clearance_m(const Scene& scene, const Eigen::Vector3d& point_m);

}  // namespace waymark::simulator
