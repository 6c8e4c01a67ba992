#pragma once

#include <optional>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// What the images of one camera alone fit.
struct CameraAlone {
  FitQuality stated;  ///< with the stated intrinsics
  FitQuality fitted;  ///< with those below
  CameraParameters parameters;

  /// The stated intrinsics do not fit, and those below do.
  [[nodiscard]] bool misfits() const {
    constexpr double kWorse = 2.0;  // than corners are worth
    constexpr double kExplains = 0.5;
    return stated.joint_px > kWorse * stated.own_px &&
           fitted.joint_px < kExplains * stated.joint_px;
  }
  /// Those below fit better, if only a little.
  [[nodiscard]] bool fits_better() const {
    constexpr double kBetter = 0.9;
    return fitted.joint_px < kBetter * stated.joint_px;
  }
};

/// Builds a map of one camera's images alone with the stated intrinsics, with these refined, and
/// with those that the squareness of its markers tells (lens_of_squares), which lie far from the
/// stated ones where the file is of another camera. The yardstick of both is what corners are worth
/// by the better of these lenses. At most 60 images, spread over the capture. nullopt when the
/// camera's images make no map.
[[nodiscard]] std::optional<CameraAlone> fit_camera_alone(const DetectedCapture& capture,
                                                          std::size_t camera,
                                                          const BuildOptions& options);

}  // namespace waymark
