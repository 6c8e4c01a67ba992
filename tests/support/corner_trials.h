#pragma once

#include <map>
#include <string>

#include "core/camera/camera_model.h"
#include "core/detect/corner_refiner.h"
#include "tests/support/marker_renderer.h"

namespace waymark::testing {

/// Markers of mixed families seen at random, refined from rough corners.
struct CornerTrials {
  int count = 100;
  double min_side_px = 45;  ///< of the mean side
  double max_side_px = 140;
  double min_tilt_deg = 0;
  double max_tilt_deg = 60;
  double rough_px = 1;  ///< rough corners are off by up to this per axis
  double quiet_zone_cells = 1;
  double white = 210;
  RenderOptions image;
  RefineOptions refine;
};

/// Errors of the refined corners against the truth.
struct CornerErrors {
  int refined = 0;
  std::map<std::string, int> failures;  ///< by reason
  double rms_px = 0;                    ///< per axis
  double max_px = 0;                    ///< largest distance
  double edge_bias_px = 0;  ///< mean outward shift of an edge: positive, the marker seems larger
  double normalized_squares = 0;  ///< mean eᵀC⁻¹e of a corner: 2 for honest covariances
  double mean_us = 0;             ///< processor time of a refinement
};

/// Runs the trials with seeds derived from their number; `camera` sees the markers around its
/// middle.
[[nodiscard]] CornerErrors run_corner_trials(const CameraModel& camera, const CornerTrials& trials);

/// A camera of 320×320 px: small images keep trials quick.
[[nodiscard]] CameraModel trial_camera(Distortion distortion = Distortion::none);

}  // namespace waymark::testing
