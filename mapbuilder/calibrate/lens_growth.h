#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// A camera's lens as its own images tell it.
struct GrownLens {
  CameraParameters parameters;
  FitQuality fit;                   ///< of its images in a map of their own
  bool firm = false;                ///< the refinement stands; else the numbers are the best tried
  std::vector<std::string> doubts;  ///< why it does not
  /// Of the kinds tried, "radtan 812, equidistant 930": Bayes' information criterion.
  std::string evidence;
};

/// Finds a camera's lens from its own images alone: from each of lens_starts() a map of its
/// markers with the lens refined in it, until one fits; the kind (none, radtan, radtan with k3,
/// rational or equidistant; or the one asked for, radtan with k3 where that explains) by Bayes'
/// information criterion over the same corners, so that a lens bends only where that explains
/// something. `alone`: captures of this camera, a rig of one each, all alike. nullopt where not one
/// map could be made: no two markers are seen together.
[[nodiscard]] std::optional<GrownLens> grow_lens(const std::vector<DetectedCapture>& alone,
                                                 std::optional<Distortion> kind,
                                                 const BuildOptions& options);

}  // namespace waymark
