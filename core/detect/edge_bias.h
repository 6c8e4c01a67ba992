#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/detect/marker_fit.h"

namespace waymark {

/// A marker that was fitted as a whole.
struct EdgeSample {
  MarkerFits fits;
  std::size_t image = 0;  ///< markers of one image share its blur
};

/// How far a camera's refined sides lie inside the black, and how it encodes light.
struct EdgeBias {
  double inset_px = 0;    ///< mean of its markers; positive: the black is larger than it looks
  double sigma_px = 0;    ///< of the mean, an open response included
  double scatter_px = 0;  ///< from marker to marker, beyond their own noise
  std::optional<SensorResponse> response;  ///< nullopt: the images do not tell
  double srgb_share = 0;    ///< probability of sRGB, by which the fits of both are weighed
  std::size_t markers = 0;  ///< that it stands on
};

/// What no number of markers takes away (px): pixels drawn otherwise. No bias is surer.
inline constexpr double kSurestEdges_px = 0.005;

/// A camera's edge bias from fitted markers (EDGES, Camera), `stated` where its response is known.
/// Markers that are clipped or have cells below 3 px tell nothing of it. nullopt: fewer than eight
/// are left, or they lie farther inside than any response, blooming or print makes them (0.25 px
/// and 0.4 of the blur): such are no prints of their family, borders that were cut for one. Depends
/// on the samples' order in rounding alone.
[[nodiscard]] std::optional<EdgeBias> edge_bias(
    std::span<const EdgeSample> samples, std::optional<SensorResponse> stated = std::nullopt);

/// How far one marker's sides lie inside its black (px): its own fit and its camera's mean, each by
/// its variance (EDGES, Correction); the mean where its fit is none or out of reason.
[[nodiscard]] double inset_of(const MarkerFits& fits, const EdgeBias& camera);

}  // namespace waymark
