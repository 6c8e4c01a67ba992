#include "mapbuilder/bundle/estimate.h"

#include "core/marker/marker_outline.h"

namespace waymark {

Calibration::Calibration(const Selection& selection)
    : rigs(selection.observations().rigs),
      sizes_m(selection.stated_sizes_m()),
      edge_bias_steps_px(selection.observations().cameras.size()) {}

double Calibration::edge_bias_px(CameraIndex camera) const {
  double sum = 0;
  for (const double step_px : edge_bias_steps_px[camera]) sum += step_px;
  return sum;
}

ImageCorners corrected_corners(const Observation& o, const Calibration& calibration) {
  ImageCorners corners_px = o.corners_px;
  for (const double step_px : calibration.edge_bias_steps_px[o.camera]) {
    move_sides_in(step_px, corners_px);
  }
  return corners_px;
}

Estimate::Estimate(const Selection& selection, const NoiseModel& noise)
    : calibration(selection),
      components(selection.components().size(), {noise, false}),
      world_from_marker(selection.observations().markers.size()),
      world_from_rig(selection.observations().frame_sets.size()),
      accepted(selection.observations().all.size(), 1) {}

void move_poses(const Component& component, const Rigid3& new_from_old, Estimate& estimate) {
  for (const MarkerIndex marker : component.markers) {
    auto& pose = estimate.world_from_marker[marker];
    if (pose) pose = new_from_old * *pose;
  }
  for (const FrameSetIndex frame_set : component.frame_sets) {
    auto& rig = estimate.world_from_rig[frame_set];
    if (!rig) continue;
    rig->best.pose = new_from_old * rig->best.pose;
    if (rig->runner_up) rig->runner_up->pose = new_from_old * rig->runner_up->pose;
  }
}

Rigid3 cam_from_marker(const Observations& observations, const Estimate& estimate,
                       const Observation& o) {
  const Rigid3& world_from_rig = estimate.world_from_rig[o.frame_set]->best.pose;
  return estimate.calibration.camera(observations, o).rig_from_cam.inverse() *
         (world_from_rig.inverse() * *estimate.world_from_marker[o.marker]);
}

}  // namespace waymark
