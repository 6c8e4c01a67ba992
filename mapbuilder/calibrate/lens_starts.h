#pragma once

#include <span>
#include <vector>

#include "core/camera/camera_model.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// Lenses of one kind from which a camera's own may be found.
struct LensStarts {
  std::vector<CameraParameters> lenses;  ///< the likeliest first; never empty
  /// What corners are worth (px per axis) by the lens of that kind that squares fit best; infinite
  /// where too few tell.
  double own_px = 0;
};

/// The homographies of a camera's markers tell (judge_lens): a square's eight numbers less its
/// pose's six. Where they leave the focal length open, which small or head-on markers do, the
/// further ones are other focal lengths. `known` gives the image's size and, of the same kind,
/// numbers to begin with; `kind` is radtan or one that bends by angle: none is the former unbent,
/// others have further coefficients.
[[nodiscard]] LensStarts lens_starts(const CameraParameters& known, Distortion kind,
                                     std::span<const ImageCorners> outlines);

}  // namespace waymark
