#pragma once

#include <array>
#include <vector>

#include "core/marker/marker_id.h"

namespace waymark::simulator {

/// A marker as printed on its plate: ink, paper, and a white margin of one cell all round. Plate
/// coordinates are in cells: x right from the margin's left edge, y down from its top edge, 0 …
/// side_cells().
class MarkerPrint {
 public:
  MarkerPrint(const MarkerId& id, float black_albedo, float white_albedo);

  /// Cells along the plate's side, margins included.
  [[nodiscard]] int side_cells() const { return side_; }
  /// Cells along the side of the marker's square, whose size is the marker's.
  [[nodiscard]] int square_cells() const { return square_; }

  /// Albedo of a cell by its place in the plate with one ring of cells around it, row by row,
  /// (side_cells() + 2)² of them; negative beyond the plate.
  [[nodiscard]] float albedo_of_cell(std::size_t place) const { return albedo_[place]; }

  /// A pixel's (or sub-pixel's) footprint on the plate: its four corners in order.
  struct Footprint {
    std::array<float, 4> x, y;
  };

  /// Albedo averaged over the footprint, exactly, over `background` where the plate ends.
  [[nodiscard]] float albedo(const Footprint& footprint, float background) const;

 private:
  [[nodiscard]] float cell(int x, int y) const {
    return albedo_[static_cast<std::size_t>((y + 1) * (side_ + 2) + x + 1)];
  }
  [[nodiscard]] float clipped_average(const Footprint& footprint, int first_x, int last_x,
                                      int first_y, int last_y, float background) const;

  int square_;
  int side_;
  std::vector<float> albedo_;  ///< with a ring of kOutside around the plate
};

}  // namespace waymark::simulator
