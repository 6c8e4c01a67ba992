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
};

/// Builds a map of one camera's images alone with the stated intrinsics and, where these contradict
/// them, from several starts: numbers in another order, scaled, squeezed, turned by 180°, without
/// distortion, focal lengths from half to twice; the best three are refined. At most 60 images,
/// spread over the capture. nullopt when the camera's images make no map.
[[nodiscard]] std::optional<CameraAlone> fit_camera_alone(const DetectedCapture& capture,
                                                          std::size_t camera,
                                                          const BuildOptions& options);

}  // namespace waymark
