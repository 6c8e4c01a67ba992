#include "mapbuilder/build/world_frame.h"

#include "core/geometry/decompositions.h"
#include "mapbuilder/build/up_direction.h"

namespace waymark {

Eigen::Vector3d camera_up_in_world(const BuiltSubMap& submap, const Observations& observations,
                                   const Calibration& calibration) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const LocalizedFrameSet& localized : submap.trajectory) {
    const RigIndex rig = observations.frame_sets[localized.frame_set].rig;
    for (const RigCamera& camera : calibration.rigs[rig].cameras) {
      sum -= localized.world_from_rig.rotation *
             (camera.rig_from_cam.rotation * Eigen::Vector3d::UnitY());
      count += 1;
    }
  }
  return count == 0 ? sum : Eigen::Vector3d(sum / count);
}

void move_world(BuiltSubMap& submap, const Rigid3& new_from_old) {
  for (MapMarker& marker : submap.map.markers) move_marker(new_from_old, marker);
  for (LocalizedFrameSet& set : submap.trajectory) {
    set.world_from_rig = new_from_old * set.world_from_rig;
  }
}

std::optional<Rigid3> level_world(const BuiltSubMap& submap, LevelBy by,
                                  const Eigen::Vector3d& camera_up_in_world) {
  const auto up = by == LevelBy::floor ? up_by_floor(submap.map, camera_up_in_world)
                                       : up_by_walls(submap.map, camera_up_in_world);
  if (!up) return std::nullopt;
  return Rigid3{shortest_rotation(*up, Eigen::Vector3d::UnitZ()), {0, 0, 0}};
}

}  // namespace waymark
