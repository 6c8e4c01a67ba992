#pragma once

#include <optional>

#include "mapbuilder/build/built_submap.h"

namespace waymark {

/// Gives a built sub-map another world: poses, covariances and trajectory move.
void move_world(BuiltSubMap& submap, const Rigid3& new_from_old);

/// Mean of the cameras' upward image directions (−y) in the world over the trajectory; its length
/// is 1 when they never turned over and 0 when they looked everywhere, or there is no trajectory.
[[nodiscard]] Eigen::Vector3d camera_up_in_world(const BuiltSubMap& submap,
                                                 const Observations& observations,
                                                 const Calibration& calibration);

/// What tells where up is.
enum class LevelBy {
  floor,  ///< markers that lie on the floor, face up: their normals are up
  walls,  ///< markers that hang on walls: their normals are level
};

/// The rotation new_from_old about the origin that makes z point up; nullopt where the markers and
/// the cameras don't tell (up_direction.h).
[[nodiscard]] std::optional<Rigid3> level_world(const BuiltSubMap& submap, LevelBy by,
                                                const Eigen::Vector3d& camera_up_in_world);

}  // namespace waymark
