#pragma once

#include <string>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/capture/gray_image.h"
#include "core/marker/marker_id.h"
#include "tests/support/marker_renderer.h"

namespace waymark {

/// markers.toml and rig.yaml of the scene.
inline std::string scene_markers_toml() {
  return "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.2\n";
}
inline std::string scene_rig_yaml() {
  return "cam0:\n"
         "  camera_model: pinhole\n"
         "  intrinsics: [300.0, 300.0, 159.5, 119.5]\n"
         "  distortion_model: none\n"
         "  distortion_coeffs: []\n"
         "  resolution: [320, 240]\n";
}

/// A 320×240 image of tag36h11 markers 1 and 2 side by side, 70 px wide; `step` moves the camera.
inline GrayImage scene_image(int step, const testing::RenderOptions& options = {}) {
  CameraParameters parameters;
  parameters.width_px = 320;
  parameters.height_px = 240;
  parameters.fu_px = parameters.fv_px = 300;
  parameters.pu_px = 159.5;
  parameters.pv_px = 119.5;
  const CameraModel camera = *CameraModel::create(parameters);
  std::vector<testing::RenderedMarker> markers;
  for (const int number : {1, 2}) {
    testing::RenderedMarker& marker = markers.emplace_back();
    marker.id = {Family::tag36h11, number};
    marker.size_m = 0.2;
    marker.quiet_zone_cells = 2;
    testing::MarkerView view;
    view.center_px = {number == 1 ? 85.0 + step : 235.0 + step, 120.0};
    view.mean_side_px = 70;
    view.tilt_rad = 0.4;
    view.azimuth_rad = 0.3 * number;
    marker.cam_from_marker = testing::pose_seen_as(camera, view, marker.size_m);
  }
  return testing::render_markers(camera, markers, options);
}

}  // namespace waymark
