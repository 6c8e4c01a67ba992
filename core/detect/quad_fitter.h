#pragma once

#include <optional>
#include <span>

#include "core/capture/gray_image.h"
#include "core/detect/border_follower.h"
#include "core/detect/tile_thresholds.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// The quadrangle that a dark area's border (BorderFollower) goes round: corners to a fraction of a
/// pixel, clockwise as the image shows it, any of them first. nullopt for what is no quadrangle
/// with a mean side of at least `min_side_px`, and for a hole.
///
/// Four points far apart divide the border; lines fitted to the parts meet in corners that divide
/// it better, which matters where a marker is seen aslant; then lines are fitted to where the image
/// crosses the threshold.
[[nodiscard]] std::optional<ImageCorners> fit_quad(const GrayView& image,
                                                   const TileThresholds& thresholds,
                                                   std::span<const Pixel> border,
                                                   double min_side_px);

}  // namespace waymark
