#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/diagnosis/lens_of_squares.h"
#include "mapbuilder/diagnosis/mono_build.h"

namespace waymark {

/// What squares say of each capture's cameras, by their numbers; nullopt: too few.
using LensesBySquares = std::vector<std::vector<std::optional<LensBySquares>>>;

[[nodiscard]] LensesBySquares judge_lenses(const std::vector<DetectedCapture>& captures);

/// Whether squares contradict a stated lens.
[[nodiscard]] bool contradict(const LensesBySquares& lenses);

/// What corners are worth by the lenses that squares fit best (px, over all squares).
[[nodiscard]] double own_px(const LensesBySquares& lenses);

/// The captures with those lenses where the stated ones are contradicted.
[[nodiscard]] std::vector<DetectedCapture> with_lenses_of_squares(
    std::vector<DetectedCapture> captures, const LensesBySquares& lenses);

/// What the images of one camera fit.
struct CameraLens {
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

/// Of each camera of a capture, by its number; nullopt: it has no image.
using LensEvidence = std::vector<std::optional<CameraLens>>;

/// What a mono build tells of a capture's lenses (by its place among those given), whether it was
/// made with those that the capture states or with others; refined as its examination has found
/// better. Where it was made with others, the images are localized anew by the stated lens. The
/// yardstick of both is what corners are worth by the better of them.
[[nodiscard]] LensEvidence lens_evidence(const DetectedCapture& capture, std::size_t place,
                                         const MonoBuild& mono, const BuildOptions& options);

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
