#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/calibrate/found_rig.h"
#include "mapbuilder/calibrate/image_coverage.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// A calibrated rig, with the map that it was refined in.
struct RigCalibration {
  /// With sigmas (with_posterior_sigmas). Where cameras could not be linked it has no transforms.
  Rig rig;
  /// How far the calibrations by two halves of the images (halves_of) differ, in units of what
  /// they state; above 1, the rig's sigmas have been multiplied by it. nullopt where a half does
  /// not tell the rig.
  std::optional<double> halves_apart;
  std::vector<ImageCoverage> coverage;  ///< per camera
  std::vector<Finding> findings;        ///< what could not be determined, and what the map told
  FitQuality quality;
  Observations observations;
  BuildResult result;
};

/// Refines a rig that was found, with maps of all images in which lenses and places are variable
/// together, as `build --refine` makes them, until they rest; the last one without markers that are
/// found wrong. Errors: bad_data, with the reason, where captures are of different rigs, or where
/// the images leave too much of it open.
[[nodiscard]] Expected<RigCalibration> calibrate_rig(std::vector<DetectedCapture> captures,
                                                     const FoundRig& found,
                                                     const RigCalibrationOptions& options,
                                                     Progress& progress);

/// How well a rig as it is stated fits the captures; nullopt where it makes no map.
[[nodiscard]] std::optional<FitQuality> fit_of_rig(const std::vector<DetectedCapture>& captures,
                                                   const Rig& rig, const BuildOptions& options,
                                                   Progress& progress);

}  // namespace waymark
