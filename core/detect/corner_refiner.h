#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/range.h"
#include "core/camera/camera_model.h"
#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "core/marker/marker_bits.h"

namespace waymark {

/// How blurred a marker is before one looks: mean and standard deviation of ln(blur in px).
struct BlurPrior {
  double log_px = 0;
  double log_sigma = 1;
};

/// A side's blur as its own pixels determine it.
struct SideBlur {
  double log_px = 0;
  double information = 0;  ///< of ln blur, from the pixels alone
};

/// How corners are refined.
struct RefineOptions {
  /// (1–14 px) Farthest that a side may lie from the rough one. Also limited to 1.2 cells,
  /// so that no edge of the code is taken for the border's.
  double max_shift_px = 8;
  /// (1–255 grey levels) Least difference between paper and border.
  double min_contrast_grey = 10;
  /// (8–1000) Pixel columns used per side: longer sides are sampled evenly.
  int max_columns = 48;
  /// (0–1 px per axis) Error that the images' noise does not explain (paper, print, lens model),
  /// added to every corner's covariance.
  double model_sigma_px = 0.003;
  /// The image's blur as other markers show it: for saturated paper, which does not.
  std::optional<BlurPrior> blur = std::nullopt;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Corners to a few hundredths of a pixel.
struct RefinedCorners {
  ImageCorners corners;           ///< pixels of the image as captured (distorted)
  CornerCovariances covariances;  ///< px²
  double blur_px = 0;  ///< standard deviation of point spread and pixel, mean of the sides
  std::array<SideBlur, 4> side_blurs;
  double contrast_grey = 0;
  double residual_grey = 0;    ///< of the fitted pixels, RMS
  double bow_px = 0;           ///< most that a side bends beyond the lens model: calibration, paper
  double saturated_share = 0;  ///< of the paper beside the border
};

/// Why corners could not be refined.
enum class RefineFailure {
  outside_camera,  ///< the lens model or the image does not reach there, or no convex quad
  no_edge,         ///< some side has no step from dark to light within reach
  too_small,       ///< some side has too few pixels clear of the corners
  low_contrast,    ///< paper and border hardly differ
  covered,         ///< too much of some side does not look like an edge
  not_converged,   ///< the sides did not come to rest within reach of the rough ones
};

[[nodiscard]] std::string_view to_string(RefineFailure failure);

/// Our own corners: lines fitted to the marker's four sides on the raw pixels, straight in the
/// undistorted plane, and intersected there; `rough` may be several pixels off. `bits` is the
/// decoded marker's pattern: the code's cells behind the border are part of the model, so that a
/// border of two pixels does not bend the profile. A corner's covariance follows from the residuals
/// of its two sides; eᵀC⁻¹e is 0.75–1.0 times the expected on flat rendered markers, for the fit
/// lets a side bow a little.
///
/// On rendered markers from 45 px side up, tilted to 60°, PSF σ 0.6–1.0 px, noise 2 grey levels:
/// 0.015 px RMS per axis, edges within 0.001 px (bench_detect_corners). Unbiased for a linear
/// sensor; the sRGB response makes white grow: every edge moves inward by 0.25 px at σ 0.8 px.
/// Of saturated paper only the step's foot is seen; its covariances grow with the saturated share.
/// A shadow's soft edge across a marker is part of the model. The options are valid (checked).
[[nodiscard]] tl::expected<RefinedCorners, RefineFailure> refine_corners(
    const GrayView& image, const CameraModel& camera, const ImageCorners& rough,
    const MarkerBits& bits, const RefineOptions& options = {});

}  // namespace waymark
