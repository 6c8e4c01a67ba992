#pragma once

#include <optional>

#include "core/camera/camera_model.h"
#include "core/marker/marker_geometry.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// What a marker's corners (px) would look like to the camera if it were square, where its print is
/// exp(`stretch`) times as wide as high: by the homography of its outline across the line of sight,
/// so that no pose and no size is asked. As they are where three of them lie on a line or the lens
/// does not reach.
[[nodiscard]] ImageCorners as_square(const CameraModel& camera, const ImageCorners& corners_px,
                                     double stretch);

/// How much wider than high all markers are printed.
struct PrintShape {
  double stretch = 0;  ///< logarithm of width over height
  double sigma = 0;    ///< one standard deviation
  double own_px = 0;   ///< what corners are worth so, by markers' own poses
};

/// The stretch within ± 8 % by which markers' outlines fit poses of their own best, with the lenses
/// as stated; at most 300 outlines of each camera take part. nullopt where squares do as well: less
/// than five sigmas of stretch.
[[nodiscard]] std::optional<PrintShape> fit_print_shape(
    const std::vector<DetectedCapture>& captures);

/// The captures with their markers as if printed square.
[[nodiscard]] std::vector<DetectedCapture> with_square_prints(std::vector<DetectedCapture> captures,
                                                              double stretch);

/// As an error. How well every image on its own fits a map of prints so stretched, and what corners
/// are worth as squares.
[[nodiscard]] Finding finding_of(const PrintShape& shape, const FitQuality& stretched,
                                 double squares_px);

}  // namespace waymark
