#pragma once

#include <optional>

#include "core/marker/marker_geometry.h"
#include "mapbuilder/build/build_options.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// What a marker's corners would look like if it were square, where its print is exp(`stretch`)
/// times as wide as high: by the homography of its outline, so that no pose, lens or size is asked.
/// As they are where three of them lie on a line.
[[nodiscard]] ImageCorners as_square(const ImageCorners& corners_px, double stretch);

/// How much wider than high all markers are printed.
struct PrintShape {
  double stretch = 0;  ///< logarithm of width over height
  double sigma = 0;    ///< one standard deviation
  FitQuality quality;  ///< of a map of squares so stretched, every image on its own
};

/// The stretch within ± 8 % by which the images fit best, each on its own; at most 40 images of
/// each camera take part. nullopt where none fits better than squares.
[[nodiscard]] std::optional<PrintShape> fit_print_shape(
    const std::vector<DetectedCapture>& captures, const BuildOptions& options);

/// The captures with their markers as if printed square.
[[nodiscard]] std::vector<DetectedCapture> with_square_prints(std::vector<DetectedCapture> captures,
                                                              double stretch);

/// As an error. `squares`: how squares fit.
[[nodiscard]] Finding finding_of(const PrintShape& shape, const FitQuality& squares);

}  // namespace waymark
