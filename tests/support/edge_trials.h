#pragma once

#include <cstdint>
#include <optional>

#include "core/camera/camera_model.h"
#include "core/detect/edge_bias.h"
#include "tests/support/corner_trials.h"

namespace waymark::testing {

/// A camera that looks at single markers, image after image.
struct EdgeTrials {
  int images = 30;
  double min_side_px = 50;  ///< of the mean side
  double max_side_px = 110;
  double max_tilt_deg = 50;
  double blur_varies = 0;  ///< share by which the point spread varies from image to image
  RenderOptions image;
};

/// What was measured, and what is true.
struct MeasuredEdges {
  std::optional<EdgeBias> measured;
  double true_inset_px = 0;  ///< mean over the same markers, from their true corners
  double corrected_px = 0;   ///< mean inset that is left when each marker's own is taken off
  double mean_fit_ms = 0;    ///< processor time of a marker's fits
};

/// Renders, refines, fits; tag36h11, seeds derived from the image's.
[[nodiscard]] MeasuredEdges measure_edges(const CameraModel& camera, const EdgeTrials& trials);

}  // namespace waymark::testing
