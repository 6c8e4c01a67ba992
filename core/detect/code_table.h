#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/marker/marker_id.h"

namespace waymark {

/// A marker that cells may show.
struct CodeMatch {
  MarkerId marker;
  int wrong_bits = 0;
  int turn = 0;  ///< the quad's corner (0 … 3) that is the marker's top left
};

/// The codes of some families, found by what a quad shows any way up, wrong bits included. All
/// four turns of every code are kept, sorted into buckets by pieces of the code: with c bits to be
/// corrected every code that is near enough agrees in one of c + 1 pieces. So looking one up takes
/// as long as a few codes' comparison, however many there are.
class CodeTable {
 public:
  /// Families that are found in images (checked).
  explicit CodeTable(std::span<const Family> families);

  /// Code cells along a side that occur, rising.
  [[nodiscard]] std::span<const int> sizes() const { return sizes_; }

  /// Appends the nearest marker of each family with codes of `code_cells`² cells, where one is as
  /// near as its family corrects (correctable_bits). Bit (row · code_cells + column) of `code` is
  /// set for a white cell; rows run down from the quad's first corner, columns to its second.
  void find(int code_cells, std::uint64_t code, std::vector<CodeMatch>& matches) const;

 private:
  struct Turned {
    std::uint64_t code = 0;
    std::int32_t number = 0;
    std::int32_t turn = 0;
  };
  /// Codes by the value of `length` bits from `first` on.
  struct Piece {
    int first = 0;
    int length = 0;
    std::vector<std::uint32_t> ends;    ///< by bucket: the end of its codes
    std::vector<std::uint32_t> sorted;  ///< indices of codes
    [[nodiscard]] std::size_t bucket(std::uint64_t code) const;
  };
  struct Codes {
    Family family;
    int code_cells = 0;
    int corrected = 0;
    std::vector<Turned> turned;
    std::vector<Piece> pieces;
  };
  [[nodiscard]] static Codes codes_of(Family family);
  static void sort_into_pieces(Codes& codes);

  std::vector<Codes> families_;
  std::vector<int> sizes_;
};

}  // namespace waymark
