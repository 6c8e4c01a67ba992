#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/marker/marker_id.h"

namespace waymark {

/// The marker's cells as printed, upright, border included: (code_cells + 2)² values row by row
/// from the top-left as seen from the front; 0 = black, 1 = white. Upright is as OpenCV draws the
/// ArUco families and as AprilTag's own library draws the AprilTag families (there OpenCV's
/// pictures stand upside down). The id's number must lie within its family (checked).
struct MarkerBits {
  int cells = 0;  ///< along one side, with the border
  std::vector<std::uint8_t> white;

  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cells) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] bool is_white(int row, int column) const { return white[index(row, column)] != 0; }
};

[[nodiscard]] MarkerBits marker_bits(const MarkerId& id);

/// Most cells along the side of a marker that can be found in images, border included.
inline constexpr int kMaxMarkerCells = 9;

/// The cells of all markers of some families (each found in images, checked), made once: looking
/// one up allocates nothing.
class MarkerBitsTable {
 public:
  explicit MarkerBitsTable(std::span<const Family> families);

  /// The marker must be one of the table's families' (checked).
  [[nodiscard]] const MarkerBits& of(const MarkerId& id) const;

 private:
  std::map<Family, std::vector<MarkerBits>> families_;
};

}  // namespace waymark
