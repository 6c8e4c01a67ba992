#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/capture/gray_image.h"
#include "core/detect/cell_steps.h"
#include "core/detect/image_side.h"

namespace waymark {

/// What a side of a marker looks like. Black runs linearly from the side's start to its end, white
/// with the light's unevenness besides; the edge between is a Gaussian step.
struct SideAppearance {
  Eigen::Vector2d black_grey;  ///< at start and end
  Eigen::Vector2d white_grey;
  /// How much brighter the paper is than linear: in the side's middle, and a quarter before it as
  /// much as it is darker a quarter behind it. A shadow's edge across a marker would else pass for
  /// a shift of its sides.
  Eigen::Vector2d uneven_grey = Eigen::Vector2d::Zero();
  double paper_end = 0;   ///< share of the contrast lost one cell outside, where the paper may end
  double blur_px = 1.0;   ///< standard deviation of point spread and pixel together
  double bow_px = 0;      ///< how far out its middle lies, beyond the camera model
  double noise_grey = 0;  ///< residual scale of the last fit, for the robust weights

  [[nodiscard]] double contrast_grey() const { return 0.5 * (white_grey.sum() - black_grey.sum()); }
};

/// The other sides' appearance as a prior for this one's: a thin or short side does not determine
/// its own.
struct SidePrior {
  SideAppearance mean;
  double black_sigma = 0;     ///< grey levels
  double white_sigma = 0;     ///< likewise
  double uneven_sigma = 0;    ///< of SideAppearance::uneven_grey about 0 (grey levels)
  double log_blur_sigma = 0;  ///< of ln blur
};

/// One Gauss–Newton step of a side's fit.
struct SideStep {
  Eigen::Vector2d shift_px;    ///< outward, at start and end
  Eigen::Matrix2d covariance;  ///< of the shift (px²)
  SideAppearance appearance;
  double information_blur = 0;  ///< of ln blur, from the pixels alone
  int pixels = 0;
  double outlier_share = 0;    ///< of the pixels, by robust weight
  double saturated_share = 0;  ///< of the pixels on the paper, at the sensor's upper end
};

/// The side, the others (before, after, opposite) and the cells behind it.
struct SideScene {
  const ImageSide& side;
  const ImageSide& before;
  const ImageSide& after;
  const ImageSide& opposite;
  const CellSteps& cells;
};

/// Fits the raw pixels of the band around the side, none interpolated: grey = black + (white −
/// black) · whiteness with whiteness the Gaussian-blurred steps of the outer edge, of the code's
/// cells behind the border, and of the paper's end where the quiet zone is one cell wide. The
/// pixel's own square adds 1/12 px² to the blur's variance, in every direction. Robust weights
/// (Geman–McClure, 4 σ) shut out what covers or stains the edge. nullopt with fewer than
/// `kMinSidePixels` usable pixels.
[[nodiscard]] std::optional<SideStep> fit_side(const GrayView& image, const SideScene& scene,
                                               const SideAppearance& start, const SidePrior& prior,
                                               int max_columns);

inline constexpr int kMinSidePixels = 12;

}  // namespace waymark
