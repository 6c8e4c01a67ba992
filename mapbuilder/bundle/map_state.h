#pragma once

#include <optional>
#include <vector>

#include "core/estimate/rig_pose_solver.h"
#include "mapbuilder/observations/covisibility.h"
#include "mapbuilder/observations/observation_table.h"

namespace waymark {

/// What is known of a table's unknowns while a map is being built. World frame: the one that the
/// component's seed was put into.
struct MapState {
  std::vector<std::optional<Rigid3>> world_from_marker;  ///< per marker; nullopt: not placed
  std::vector<std::optional<RigPoseEstimate>> rigs;      ///< per frame set; nullopt: not localized
  std::vector<char> accepted;  ///< per observation: 1 unless the gate rejects it

  explicit MapState(const ObservationTable& table)
      : world_from_marker(table.markers.size()),
        rigs(table.frame_sets.size()),
        accepted(table.observations.size(), 1) {}

  /// Whether both ends of an observation have a pose.
  [[nodiscard]] bool posed(const TableObservation& o) const {
    return world_from_marker[static_cast<std::size_t>(o.marker)].has_value() &&
           rigs[static_cast<std::size_t>(o.frame_set)].has_value();
  }
};

/// Gives what is posed of a component another world.
inline void move_poses(const Component& component, const Rigid3& new_from_old, MapState& state) {
  for (const int marker : component.markers) {
    auto& pose = state.world_from_marker[static_cast<std::size_t>(marker)];
    if (pose) pose = new_from_old * *pose;
  }
  for (const int frame_set : component.frame_sets) {
    auto& rig = state.rigs[static_cast<std::size_t>(frame_set)];
    if (!rig) continue;
    rig->best.pose = new_from_old * rig->best.pose;
    if (rig->runner_up) rig->runner_up->pose = new_from_old * rig->runner_up->pose;
  }
}

/// Camera and rig of an observation.
[[nodiscard]] inline const RigCamera& camera_of(const ObservationTable& table,
                                                const TableObservation& o) {
  const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(o.frame_set)];
  return table.rigs[static_cast<std::size_t>(set.rig)].cameras[static_cast<std::size_t>(o.camera)];
}

/// cam_from_marker by the state's poses; both ends must be posed.
[[nodiscard]] inline Rigid3 cam_from_marker(const ObservationTable& table, const MapState& state,
                                            const TableObservation& o) {
  const Rigid3& world_from_rig = state.rigs[static_cast<std::size_t>(o.frame_set)]->best.pose;
  return camera_of(table, o).rig_from_cam.inverse() *
         (world_from_rig.inverse() * *state.world_from_marker[static_cast<std::size_t>(o.marker)]);
}

}  // namespace waymark
