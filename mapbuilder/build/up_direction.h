#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/map/marker_map.h"

namespace waymark {

// Which way up is in a sub-map's world, by its markers' normals and by `camera_up`, the mean of the
// cameras' upward image directions in that world: of length 1 when they never turned over and 0
// when they looked everywhere, which says nothing.

/// By markers that lie on the floor, face up: the direction that normals share nearest to the
/// cameras' up, or, where that says nothing, most normals. A wall's normals are level to cameras
/// that stand upright and never pass for a floor's. nullopt where fewer than 2 markers tell, where
/// two directions would do alike, and where cameras look straight down and never turn, so that
/// floor and wall look alike.
[[nodiscard]] std::optional<Eigen::Vector3d> up_by_floor(const SubMap& submap,
                                                         const Eigen::Vector3d& camera_up);

/// By markers on walls, whose normals are level; its sign by the cameras, which stand upright on
/// the whole. nullopt where all walls face along one line, or the cameras don't tell the sign.
[[nodiscard]] std::optional<Eigen::Vector3d> up_by_walls(const SubMap& submap,
                                                         const Eigen::Vector3d& camera_up);

/// The best guess for a picture, where anything is better than nothing: the direction that walls
/// stand along and floors and ceilings face, nearest to the cameras' up.
[[nodiscard]] Eigen::Vector3d guess_up(const SubMap& submap, const Eigen::Vector3d& camera_up);

}  // namespace waymark
