#pragma once

#include <algorithm>
#include <vector>

#include "tests/support/synthetic_room.h"

namespace waymark::test {

/// The room as another lens would have taken it.
inline SyntheticRoom taken_by(SyntheticRoom room, const CameraParameters& lens) {
  const CameraModel straight = room.rig.cameras[0].model;
  const CameraModel other = *CameraModel::create(lens);
  for (ImageDetections& image : room.images) {
    std::erase_if(image.detections, [&](Detection& detection) {
      for (Eigen::Vector2d& corner : detection.corners) {
        const auto there = other.project(*straight.bearing(corner));
        if (!there || !other.in_image(*there)) return true;
        corner = *there;
      }
      return false;
    });
  }
  for (RigCamera& camera : room.rig.cameras) camera.model = other;
  return room;
}

/// Largest distance of two lenses' images of the directions of one (px), within 90 % of it.
inline double apart_px(const CameraParameters& one, const CameraParameters& other) {
  const CameraModel a = *CameraModel::create(one);
  const CameraModel b = *CameraModel::create(other);
  double most = 0;
  for (double u = 0.05; u < 1; u += 0.1) {
    for (double v = 0.05; v < 1; v += 0.1) {
      const Eigen::Vector2d pixel(u * one.width_px, v * one.height_px);
      const auto there = b.project(*a.bearing(pixel));
      most = std::max(most, there ? (*there - pixel).norm() : 1e9);
    }
  }
  return most;
}

}  // namespace waymark::test
