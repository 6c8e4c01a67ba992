#pragma once

#include <optional>
#include <string>

#include "mapbuilder/build/map_builder.h"

namespace waymark {

/// How well an estimate fits its observations, beside how well each observation fits a pose of its
/// own: the yardstick of what the corners are worth, whatever rig, clocks and map are. Per axis
/// (px), by medians, so that a few wrong ids have no say; infinite where there is nothing to judge.
struct FitQuality {
  double own_px = 0;    ///< of markers' own poses, two freedoms each
  double joint_px = 0;  ///< of all usable observations in the build, those without a pose as far
                        ///< off as can be
  /// Of the camera that fits worst, the median over its markers of each one's median, where it sees
  /// six markers or more; no less than `joint_px`. Two cameras that agree outvote a third in every
  /// median of all, and a marker that rides along is seen in each image.
  double worst_camera_px = 0;
  /// Something that all observations, or all of a camera, share is wrong: corners are good for
  /// `own_px`, and together they miss by more than four times that and a fifth of a pixel.
  [[nodiscard]] bool contradicts() const {
    return worst_camera_px > 4.0 * own_px && worst_camera_px > 0.2;
  }
};

/// A build that misses by more than this (px) is poor whatever the yardstick says: a lens that is
/// far from the stated one spoils markers' own poses, too.
inline constexpr double kPoorFit_px = 0.4;

/// By how much the worst camera misses: "7.9 px", or in words where that is infinite.
[[nodiscard]] std::string worst_camera_text(const FitQuality& quality);

/// Of images each on its own: something is left that these do not fit either.
[[nodiscard]] bool is_poor(const FitQuality& mono);

/// Squared residual (px², of eight numbers) by the estimate's poses; infinite where it has none.
[[nodiscard]] double joint_residual_px2(const Observations& observations, const Estimate& estimate,
                                        const Observation& o);

/// With the estimate's lenses and sizes; `only`: of one rig's observations.
[[nodiscard]] FitQuality fit_quality(const Selection& selection, const Estimate& estimate,
                                     std::optional<RigIndex> only = {});

}  // namespace waymark
