#pragma once

#include <cstdint>
#include <optional>

#include "core/capture/gray_image.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// What a quadrangle shows when its border is one cell wide.
struct QuadCode {
  std::uint64_t code = 0;    ///< bit (row · code_cells + column): the cell is white
  double contrast_grey = 0;  ///< of white and black
  /// How far cells are from both levels, mean of all, as a share of the contrast: 0 for clear ones,
  /// 0.25 for greys at random.
  double greyness = 0;
};

/// Reads the cells of a marker whose code has `code_cells`² of them, at the image's full
/// resolution, through the homography of the corners (clockwise). Black is a plane through the
/// border's greys, white one through the white cells' (after libapriltag), so that light may run
/// across; small cells are sharpened, for they mix. nullopt where the border is not dark but for an
/// eighth of it, the contrast is below `least_contrast_grey`, or the corners lie on a line.
[[nodiscard]] std::optional<QuadCode> read_quad_code(const GrayView& image,
                                                     const ImageCorners& corners, int code_cells,
                                                     double least_contrast_grey);

}  // namespace waymark
