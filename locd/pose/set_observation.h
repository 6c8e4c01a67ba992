#pragma once

#include <array>
#include <cstddef>

#include "core/capture/detection.h"
#include "core/estimate/marker_observation.h"

namespace waymark {

/// One detection of a mapped marker, on its way into a pose.
struct SetObservation {
  MarkerObservation observation;    ///< corners as they would be at the set's stamp
  ImageCorners detected_px;         ///< as detected
  CornerCovariances stated;         ///< the detector's (px²); zero when it states none
  std::array<double, 4> after_s{};  ///< each corner's instant less the set's stamp
  std::size_t map_index = 0;
  std::size_t report_index = 0;  ///< into PoseEstimate::observations
  bool inlier = false;
  double sigmas_squared = 0;  ///< at the pose; 8 degrees of freedom
  double rms_px = 0;          ///< NaN when a corner can't be projected
};

}  // namespace waymark
