#pragma once

#include <cstdint>
#include <vector>

#include "simulator/camera_view.h"
#include "simulator/renderer.h"
#include "simulator/tile_rays.h"

namespace waymark::simulator {

/// Paints one marker's plate into the rows of a tile, from top to bottom.
class PlatePainter {
 public:
  PlatePainter(const MarkerPrint& print, const PlateInView& plate, int surface,
               const SubpixelGrid& grid);

  /// The surface that the marker hangs on; the plate is seen where the surface is.
  [[nodiscard]] int surface() const { return surface_; }

  /// Whether the plate reaches the sub-pixels between corner rows `row` and `row` + 1.
  [[nodiscard]] bool reaches(std::size_t row) const {
    return row >= first_row_ && row <= last_row_;
  }
  /// Whether corner row `row` is needed.
  [[nodiscard]] bool needs_corners(std::size_t row) const {
    return row >= first_row_ && row <= last_row_ + 1;
  }

  /// Takes the next corner row; `share` see MovingPlane::at.
  void advance(const CornerRays& corners, const SubpixelGrid& grid, float share);

  /// Replaces the albedo of sub-pixels between the last two corner rows. Only where `seen` equals
  /// `key`, unless `seen` is null.
  void paint(const SubpixelGrid& grid, const std::int32_t* seen, std::int32_t key,
             float* albedo) const;

 private:
  /// Plate coordinates and cells of one row of corners, from column begin_ to end_, phase by phase.
  struct CornerRow {
    std::vector<float> x, y;
    std::vector<std::int32_t> cell;
  };

  const MarkerPrint* print_;
  MovingPlane plane_;
  int surface_;
  std::size_t begin_, end_;  ///< pixel columns of the grid
  std::size_t first_row_, last_row_;
  CornerRow upper_, lower_;
};

}  // namespace waymark::simulator
