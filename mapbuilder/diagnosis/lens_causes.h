#pragma once

#include <optional>
#include <string>

#include "core/base/cause.h"
#include "core/camera/camera_model.h"

namespace waymark {

/// How the numbers that a camera's images fit differ from those stated, by the simplest cause.
struct LensExplanation {
  Cause cause = Cause::intrinsics;
  double value =
      0;  ///< in `unit`: focal length or aspect (%), principal point's or lens's shift (px)
  std::string unit;
  std::string detail;  ///< plain words after the camera's name
  std::string remedy;
};

/// In the order in which a person would check: numbers in another order, another resolution, images
/// squeezed, turned by 180°, cropped, rectified; else focal length or lens. nullopt when the two
/// project alike within 2 % of the focal length and 2 px of the principal point and lens, which a
/// calibration may leave.
[[nodiscard]] std::optional<LensExplanation> explain_lens(const CameraParameters& stated,
                                                          const CameraParameters& fitted);

}  // namespace waymark
