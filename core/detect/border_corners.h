#pragma once

#include <array>
#include <optional>
#include <span>

#include "core/detect/border_follower.h"

namespace waymark {

/// Indices of a border's pixels, rising, that divide it into four sides.
using BorderCorners = std::array<std::size_t, 4>;

/// Where a dark area's border (BorderFollower) has its corners, if it runs near the sides of a
/// quadrangle for most of each; nullopt if not, and for holes. Looks at some 60 pixels of the
/// border only, so corners are off by as many steps as lie between two, and by more where the
/// quadrangle is slender. Borders that stray into a marker through gaps of its own thin border are
/// taken.
[[nodiscard]] std::optional<BorderCorners> find_border_corners(std::span<const Pixel> border,
                                                               double min_side_px);

}  // namespace waymark
