#pragma once

#include <optional>
#include <span>

#include "core/detect/border_follower.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// The rectangle of least area around all pixels, from edge to edge: clockwise as the image shows
/// it, any corner first. nullopt for pixels on a line. One of its sides lies along one of the
/// convex hull's (Freeman and Shapira, 1975).
[[nodiscard]] std::optional<ImageCorners> smallest_rectangle(std::span<const Pixel> pixels);

}  // namespace waymark
