#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/capture/detection.h"
#include "core/capture/gray_image.h"
#include "core/marker/marker_id.h"

namespace waymark {

class SquarePixels;

/// How a square shows a code: as the families draw it, or otherwise.
struct SquareForm {
  Family family = Family::aruco_4x4_1000;
  bool mirrored = false;      ///< left and right exchanged
  bool other_border = false;  ///< the black border is not one cell wide

  auto operator<=>(const SquareForm&) const = default;
};

/// A code that a square shows.
struct SquareReading {
  SquareForm form;
  int number = 0;
  int wrong_bits = 0;
  double border_cells = 1;  ///< measured width of the black border, in cells of the code
  int first_corner = 0;     ///< the square's (0 … 3) that is the code's top left
};

/// What a square may be.
struct SquareLook {
  std::vector<SquareReading> readings;  ///< each form once

  /// Whether its rim and cells are such that a code of the form could stand there.
  [[nodiscard]] bool could_show(const SquareForm& form) const;
  std::uint8_t cells_of_usual_border = 0;  ///< bit k: k × k cells could be read
  std::uint8_t cells_of_other_border = 0;
};

/// Reads squares as codes of all families at once, mirrored ones and other borders too. Of families
/// of which one begins with the other (aruco_4x4_50, _1000) the largest stands for all.
class SquareReader {
 public:
  SquareReader();

  /// No readings where the rim is not dark, or no family has such a code.
  [[nodiscard]] SquareLook read(const GrayView& image, const ImageCorners& square) const;

  /// The same of what its white cells fill alone, whatever is around the border.
  [[nodiscard]] SquareLook read_inside(const GrayView& image, const ImageCorners& code_area) const;

  /// The chance that cells at random read as a code of the form, whose family is one of families()
  /// (checked); `exact`: without a wrong bit.
  [[nodiscard]] double chance_of(const SquareForm& form, bool exact) const;

  /// Those that stand for all.
  [[nodiscard]] static std::span<const Family> families();

 private:
  struct Codes {
    Family family;
    int cells;                         ///< along the code's side
    int corrected;                     ///< bits
    std::vector<std::uint64_t> codes;  ///< by number, row by row from the top left
  };
  void read_at(const SquarePixels& pixels, int cells, double border, SquareLook& look) const;
  void decode(std::uint64_t bits, int cells, bool mirrored,
              std::vector<SquareReading>& readings) const;

  std::vector<Codes> families_;
};

}  // namespace waymark
