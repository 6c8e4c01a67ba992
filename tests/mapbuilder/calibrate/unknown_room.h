#pragma once

#include "mapbuilder/calibrate/calibrated_cameras.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark::test {

/// What is known of a camera before it is calibrated: its image's size.
inline CameraModel unknown_lens(const CameraModel& lens) {
  CameraParameters p;
  p.width_px = lens.parameters().width_px;
  p.height_px = lens.parameters().height_px;
  p.fu_px = p.fv_px = p.width_px;
  p.pu_px = 0.5 * (p.width_px - 1);
  p.pv_px = 0.5 * (p.height_px - 1);
  return *CameraModel::create(p);
}

/// A room as a capture without a rig file: lenses and places unknown.
inline DetectedCapture capture_of_unknown_rig(const SyntheticRoom& room) {
  DetectedCapture capture = capture_of(room);
  for (RigCamera& camera : capture.rig.cameras) {
    camera.model = unknown_lens(camera.model);
    camera.rig_from_cam = Rigid3{};
    camera.stated_sigmas = {};
  }
  capture.rig.has_extrinsics = capture.rig.cameras.size() == 1;
  return capture;
}

inline SyntheticRoom noisy_room(int cameras, int frame_sets = 60) {
  RoomOptions options;
  options.noise_px = 0.1;
  options.cameras = cameras;
  options.frame_sets = frame_sets;
  return make_room(options);
}

}  // namespace waymark::test
