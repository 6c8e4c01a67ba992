#pragma once

#include <optional>
#include <vector>

#include "core/estimate/rig_pose_solver.h"
#include "mapbuilder/bundle/noise_model.h"
#include "mapbuilder/observations/selection.h"

namespace waymark {

/// What is known of rigs, prints and edges, where an estimate may differ from what was stated.
struct Calibration {
  IndexedVector<RigIndex, Rig> rigs;
  IndexedVector<MarkerIndex, double> sizes_m;
  /// How far each camera's edges lie outside (px): outward shifts in the order in which they were
  /// found. Corners are moved in by one after the other, each along the outline that the ones
  /// before have left.
  IndexedVector<CameraIndex, std::vector<double>> edge_bias_steps_px;

  Calibration() = default;
  /// As stated, edges where they are seen.
  explicit Calibration(const Selection& selection);

  [[nodiscard]] double edge_bias_px(CameraIndex camera) const;
  /// Camera of an observation.
  [[nodiscard]] const RigCamera& camera(const Observations& observations,
                                        const Observation& o) const {
    const CameraPlace& place = observations.cameras[o.camera];
    return rigs[place.rig].cameras[place.in_rig];
  }
};

/// An observation's corners with the camera's edge bias taken out.
[[nodiscard]] ImageCorners corrected_corners(const Observation& o, const Calibration& calibration);

/// What a component has of its own.
struct ComponentEstimate {
  NoiseModel noise;
  bool converged = false;  ///< the last adjustment did, with gate, flips and noise at rest
};

/// All that is known of the unknowns of a map at one moment of its making: a value. Steps take one
/// and return another; a copy is the way back. World frame of each component: that of its seed's
/// rig, or the survey's.
struct Estimate {
  Calibration calibration;
  IndexedVector<ComponentIndex, ComponentEstimate> components;
  IndexedVector<MarkerIndex, std::optional<Rigid3>> world_from_marker;  ///< nullopt: not placed
  /// With its runner-up; nullopt: not localized.
  IndexedVector<FrameSetIndex, std::optional<RigPoseEstimate>> world_from_rig;
  IndexedVector<ObservationIndex, char> accepted;  ///< 1 unless the gate rejects it

  Estimate() = default;
  /// Nothing is posed, everything accepted, the calibration as stated.
  Estimate(const Selection& selection, const NoiseModel& noise);

  /// Whether both ends of an observation have a pose.
  [[nodiscard]] bool posed(const Observation& o) const {
    return world_from_marker[o.marker].has_value() && world_from_rig[o.frame_set].has_value();
  }
  [[nodiscard]] bool accepts(ObservationIndex index) const { return accepted[index] != 0; }
};

/// Gives what is posed of a component another world.
void move_poses(const Component& component, const Rigid3& new_from_old, Estimate& estimate);

/// cam_from_marker by the estimate's poses; both ends must be posed.
[[nodiscard]] Rigid3 cam_from_marker(const Observations& observations, const Estimate& estimate,
                                     const Observation& o);

}  // namespace waymark
