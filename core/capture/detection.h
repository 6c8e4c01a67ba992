#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/geometry/stamp.h"
#include "core/marker/marker_geometry.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// Covariances (px²) of the four corners, in the order of `Corner`.
using CornerCovariances = std::array<Eigen::Matrix2d, 4>;

/// A marker found in one image.
struct Detection {
  MarkerId marker;
  ImageCorners corners;  ///< pixels of the image as captured (distorted)
  std::optional<CornerCovariances> covariances;
  int hamming = 0;  ///< corrected code bits
};

/// One image and what was found in it (maybe nothing).
struct ImageDetections {
  Stamp stamp{0};
  int camera = 0;  ///< index in the rig
  std::vector<Detection> detections;
};

}  // namespace waymark
