#pragma once

#include <optional>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// A map of every image on its own, whatever rig files, clocks and survey say.
struct MonoBuild {
  Observations observations;
  BuildResult result;
  FitQuality quality;
};

/// With the lenses as stated. nullopt where the captures make no observations.
[[nodiscard]] std::optional<MonoBuild> build_mono(const std::vector<DetectedCapture>& captures,
                                                  const BuildOptions& options, Progress& progress);

/// The captures with at most so many images of each camera, evenly spread.
[[nodiscard]] std::vector<DetectedCapture> thinned(std::vector<DetectedCapture> captures,
                                                   std::size_t images_per_camera);

}  // namespace waymark
