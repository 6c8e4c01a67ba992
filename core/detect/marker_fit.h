#pragma once

#include <array>
#include <optional>

#include "core/camera/camera_model.h"
#include "core/camera/sensor_response.h"
#include "core/capture/gray_image.h"
#include "core/marker/marker_bits.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// A marker's image explained as a whole under one sensor response, its corners free.
struct MarkerFit {
  ImageCorners corners;     ///< of the black, as captured (px)
  double blur_px = 0;       ///< standard deviation, geometric mean over directions
  double growth_px = 0;     ///< by which white grows over every edge: print, blooming
  double growth_sigma = 0;  ///< formal, px
  double misfit = 0;        ///< bounded squares of what is not explained, in those of both fits
  /// How far the given sides' middles lie inside the fitted black, mean of the sides (px).
  double inset_px = 0;
};

/// The same pixels under both responses.
struct MarkerFits {
  std::array<std::optional<MarkerFit>, 2> by_response;  ///< none: did not converge
  double clipped_share = 0;                             ///< of the pixels: white or black ends
  double cell_px = 0;                                   ///< of the shortest side

  [[nodiscard]] const std::optional<MarkerFit>& of(SensorResponse response) const {
    return by_response[static_cast<std::size_t>(response)];
  }
};

/// Fits a marker's cells and the paper around them to the pixels between (EDGES, Model): corners,
/// an elliptic blur, the growth of white, light that varies over the marker; 21 numbers.
/// `corners` are refined ones (captured px). At most 800 pixels (MarkerPixels); none is
/// interpolated. nullopt where the lens or the image does not reach, or corners lie on a line.
[[nodiscard]] std::optional<MarkerFits> fit_marker(const GrayView& image, const CameraModel& camera,
                                                   const ImageCorners& corners,
                                                   const MarkerBits& bits);

}  // namespace waymark
