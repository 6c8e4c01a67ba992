#pragma once

#include <vector>

#include "core/camera/camera_model.h"
#include "simulator/plane_map.h"
#include "simulator/renderer.h"

namespace waymark::simulator {

/// A plane's map at the first and at the last row of a band of image rows; between them it moves
/// evenly.
struct MovingPlane {
  int index = 0;  ///< of the surface, or of the marker
  PlaneMap first, last;

  [[nodiscard]] PlaneMap at(float share) const { return PlaneMap::between(first, last, share); }
};

/// A marker's plate and the part of the image that it can reach (px, inclusive).
struct PlateInView {
  MovingPlane plane;  ///< plate coordinates, in cells, y up from the plate's centre
  int left_px, right_px, top_px, bottom_px;
};

/// What one band of image rows sees during one sub-exposure.
struct CameraView {
  std::vector<MovingPlane> surfaces;  ///< those the camera is in front of; coordinates in m
  std::vector<PlateInView> plates;
};

/// World poses of the camera at the band's first and last row.
[[nodiscard]] CameraView view_of(const Renderer::Stage& stage, const CameraModel& camera,
                                 const Rigid3& world_from_cam_first,
                                 const Rigid3& world_from_cam_last);

}  // namespace waymark::simulator
