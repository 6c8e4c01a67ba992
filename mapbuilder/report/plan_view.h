#pragma once

#include <Eigen/Geometry>

#include "core/map/marker_map.h"

namespace waymark {

/// How a sub-map is laid out for people: z up, x to the right on the floor plan.
struct PlanView {
  Eigen::Quaterniond plan_from_world = Eigen::Quaterniond::Identity();
  bool z_is_up = false;  ///< known; otherwise up is guessed
};

/// The plan view of a sub-map. Where z is known to be up, the world's own axes. Elsewhere up is the
/// direction that walls stand along and floors and ceilings face, nearest to where the cameras' up
/// points on average (`camera_up_in_world`, of length 0 to 1: how much that says); the plan's x
/// axis lies along the walls, the longer way. Only a view: no coordinate of the map changes.
[[nodiscard]] PlanView plan_view(const SubMap& submap, const Eigen::Vector3d& camera_up_in_world);

}  // namespace waymark
