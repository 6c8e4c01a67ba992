#include "core/detect/expected_marker.h"

#include <algorithm>
#include <cmath>

#include "core/detect/tile_thresholds.h"

namespace waymark {

ImageWindow window_of(const ExpectedMarker& expected) {
  // Thresholds look at a tile and its neighbours: an edge that has as much around it is seen as in
  // the whole.
  constexpr double kMargin_px = 2 * TileThresholds::kTilePx;
  constexpr double kFarthest_px = 1e6;
  Eigen::Vector2d low = expected.corners[0];
  Eigen::Vector2d high = expected.corners[0];
  for (const Eigen::Vector2d& corner : expected.corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const auto whole = [&](double px) {
    return static_cast<int>(std::clamp(px, -kFarthest_px, kFarthest_px));
  };
  const double around = expected.reach_px + kMargin_px;
  ImageWindow window;
  window.left_px = whole(std::floor(low.x() - around));
  window.top_px = whole(std::floor(low.y() - around));
  window.width_px = whole(std::ceil(high.x() + around)) + 1 - window.left_px;
  window.height_px = whole(std::ceil(high.y() + around)) + 1 - window.top_px;
  return window;
}

}  // namespace waymark
