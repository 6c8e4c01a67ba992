#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/marker/marker_id.h"
#include "core/marker/marker_layout.h"

namespace waymark {

/// The marker's cells as printed, upright, row by row from the top-left of all as seen from the
/// front: those of its square, border included, and `outside` rings around it. Upright is as OpenCV
/// draws the ArUco families and as AprilTag's own library draws the AprilTag families (there
/// OpenCV's pictures stand upside down).
struct MarkerBits {
  const MarkerLayout* layout = nullptr;  ///< the family's; lives as long as the program
  int cells = 0;                         ///< along the square's side, with its border
  int outside = 0;                       ///< rings of cells around the square that are the marker's
  /// 0 = black or nothing, 1 = white; all_cells()² of them, the rest is 0.
  std::array<std::uint8_t, std::size_t{kMaxMarkerCells} * kMaxMarkerCells> white{};

  [[nodiscard]] int all_cells() const { return cells + 2 * outside; }
  /// Of the square's cells from 0 on; around it from −outside to cells + outside − 1.
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>((row + outside) * all_cells() + column + outside);
  }
  [[nodiscard]] bool is_white(int row, int column) const { return white[index(row, column)] != 0; }
  /// What the layout has there, whatever the id.
  [[nodiscard]] CellKind kind(int row, int column) const { return layout->at({row, column}); }
  /// Whether the square is white in black, instead of black in white.
  [[nodiscard]] bool is_light() const { return is_white(0, 0); }
};

/// The id's number must lie within its family (checked). Allocates nothing, takes 0.1 µs.
[[nodiscard]] MarkerBits marker_bits(const MarkerId& id);

/// Black for white and white for black, as a negative shows it.
[[nodiscard]] MarkerBits negative_of(MarkerBits bits);

}  // namespace waymark
