#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/marker/family.h"

namespace waymark {

/// What a cell of a family's markers is.
enum class CellKind : std::uint8_t {
  black,
  white,
  code,     ///< black or white, by the id
  nothing,  ///< beyond a round marker; whatever is behind it
};

/// A cell by its place from the square's top left: 0, 0 is the first of the square's own, rows run
/// down. What lies around the square is negative, or beyond square_cells − 1.
struct CellPlace {
  int row = 0;
  int column = 0;

  bool operator==(const CellPlace&) const = default;
};

/// Where the cells of a family's markers are. Every marker has a square of one colour against
/// another, whose corners are the marker's corners and whose side is its size. ArUco's families and
/// AprilTag's first ones have a black square on white paper, the code inside. AprilTag's later ones
/// have a white square in a black ring, and more of the code around that ring.
class MarkerLayout {
 public:
  /// One character a cell: '.' black, '#' white, 'c' code, ' ' nothing; all rows as long as there
  /// are rows (checked).
  MarkerLayout(std::span<const std::string_view> picture, int square_cells);

  /// Along the square's side, its border included.
  [[nodiscard]] int square_cells() const { return square_cells_; }
  /// Rings of cells around the square.
  [[nodiscard]] int outside_cells() const { return outside_cells_; }
  /// Along the whole marker's side.
  [[nodiscard]] int all_cells() const { return square_cells_ + 2 * outside_cells_; }
  /// Whether the square is white in a black ring, instead of black on white paper.
  [[nodiscard]] bool is_light() const { return outside_cells_ > 0; }

  [[nodiscard]] CellKind at(const CellPlace& place) const { return kinds_[index(place)]; }
  /// Row by row from the top left of all: bit i of a code is cell i.
  [[nodiscard]] const std::vector<CellPlace>& code() const { return code_; }

  bool operator==(const MarkerLayout&) const = default;

 private:
  [[nodiscard]] std::size_t index(const CellPlace& place) const {
    return static_cast<std::size_t>((place.row + outside_cells_) * all_cells() + place.column +
                                    outside_cells_);
  }

  int square_cells_;
  int outside_cells_;
  std::vector<CellKind> kinds_;
  std::vector<CellPlace> code_;
};

/// The family's; as AprilTag's library and OpenCV draw them, see MarkerBits.
[[nodiscard]] const MarkerLayout& marker_layout(Family family);

/// Most cells along the side of a marker's square, its border included.
inline constexpr int kMaxSquareCells = 9;
/// Most along the side of a whole marker.
inline constexpr int kMaxMarkerCells = 11;

}  // namespace waymark
