#pragma once

#include <cstddef>
#include <vector>

#include "simulator/ray_table.h"

namespace waymark::simulator {

/// A rectangle of the image that is rendered at once (px).
struct Tile {
  int x0, y0;
  int width, height;
};

/// How a tile with its apron is cut into sub-pixels. A row of sub-pixels is stored phase by phase:
/// sub-pixel p of pixel i lies at index p · columns + i, so that loops run over neighbours in
/// memory.
struct SubpixelGrid {
  Tile apron;        ///< the tile and what its point spread draws from
  int oversampling;  ///< sub-pixels per pixel along an axis

  [[nodiscard]] std::size_t columns() const { return static_cast<std::size_t>(apron.width); }
  [[nodiscard]] std::size_t phases() const { return static_cast<std::size_t>(oversampling); }
  /// Sub-pixels of one row.
  [[nodiscard]] std::size_t row_length() const { return columns() * phases(); }
  [[nodiscard]] std::size_t rows() const {
    return static_cast<std::size_t>(apron.height * oversampling);
  }
  /// Image row (px, fractional) of a sub-pixel row's upper edge.
  [[nodiscard]] double edge_px(double row) const { return apron.y0 - 0.5 + row / oversampling; }
};

/// Directions at the corners of one row of sub-pixels: corner (p, i), at pixel i + p /
/// oversampling, lies at index p · stride + i, with stride = columns + 1. What is right of corner
/// (p, i) is (p + 1, i), or (0, i + 1) after the last phase.
struct CornerRays {
  std::vector<float> x, y, z;

  /// Row `row` of the grid's corners, 0 … rows().
  void compute(const RayTable& rays, const SubpixelGrid& grid, std::size_t row);
};

}  // namespace waymark::simulator
