#pragma once

#include <optional>

#include "core/capture/gray_image.h"
#include "core/marker/marker_bits.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// How an image agrees with a marker's cells.
struct CellReading {
  int wrong_code_cells = 0;
  int wrong_other_cells = 0;  ///< of those that no id changes: the border, a ring around it
  int other_cells = 0;        ///< all of these
  double contrast_grey = 0;  ///< mean of the cells that should be white less that of the black ones
};

/// Reads the middle of every cell, those around the square included, through the homography of the
/// corners (good for corners within a third of a cell) and holds it against the mean of the two
/// levels. nullopt when the corners lie on a line or cells outside the image. `bits` are as the
/// image shows them: of an inverted print, or in a negative, the negative's.
[[nodiscard]] std::optional<CellReading> read_cells(const GrayView& image,
                                                    const ImageCorners& corners,
                                                    const MarkerBits& bits);

}  // namespace waymark
