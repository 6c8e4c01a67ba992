#pragma once

#include <cstdint>
#include <optional>

#include "core/capture/gray_image.h"
#include "core/marker/marker_geometry.h"
#include "core/marker/marker_layout.h"

namespace waymark {

/// What a quadrangle shows when its cells are where a layout has them.
struct QuadCode {
  std::uint64_t code = 0;    ///< bit i: cell i of the layout is white
  double contrast_grey = 0;  ///< of white and black
  /// How far cells are from both levels, mean of all, as a share of the contrast: 0 for clear ones,
  /// 0.25 for greys at random.
  double greyness = 0;
};

/// Reads the cells of a marker of the layout, at the image's full resolution, through the
/// homography of the corners (clockwise). The image shows the marker's square dark: of layouts with
/// a light one, and of inverted prints, it is a negative. Black is a plane through the border's
/// greys, white one through the white cells' (after libapriltag), so that light may run across;
/// small cells are sharpened, for they mix. nullopt where the cells that no id changes are not as
/// they must be but for an eighth of them, the contrast is below `least_contrast_grey`, or the
/// corners lie on a line.
[[nodiscard]] std::optional<QuadCode> read_quad_code(const GrayView& image,
                                                     const ImageCorners& corners,
                                                     const MarkerLayout& layout,
                                                     double least_contrast_grey);

}  // namespace waymark
