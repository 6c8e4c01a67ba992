#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/camera_alone.h"
#include "mapbuilder/diagnosis/finding.h"

namespace waymark {

/// What each camera of a capture fits alone, by its number; nullopt: its images make no map.
using LensEvidence = std::vector<std::optional<CameraAlone>>;

[[nodiscard]] LensEvidence lens_evidence(const DetectedCapture& capture,
                                         const BuildOptions& options);

/// The capture with lenses that fit its images, whatever keeps the stated ones from it: by these,
/// where cameras stood can be told.
[[nodiscard]] DetectedCapture with_fitted_lenses(DetectedCapture capture,
                                                 const LensEvidence& evidence);

/// Whose stated lens is another one's: a finding per camera, and the fitted lens takes the stated
/// one's place in `capture`. A lens that only bends otherwise than stated, by no more than markers'
/// own poses hide, is left to a refinement.
[[nodiscard]] std::vector<Finding> correct_lenses(const LensEvidence& evidence,
                                                  DetectedCapture& capture);

}  // namespace waymark
