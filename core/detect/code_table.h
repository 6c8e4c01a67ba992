#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/marker/marker_id.h"
#include "core/marker/marker_layout.h"

namespace waymark {

/// A marker that cells may show.
struct CodeMatch {
  MarkerId marker;
  int wrong_bits = 0;
  int turn = 0;  ///< the quad's corner (0 … 3) that is the marker's top left
};

/// Code cells that a detector may correct in a family: as many as its codes' distance allows
/// without mistaking one for another, while cells at random read as some marker with a chance of at
/// most 1e-3: 36h11 corrects 3 of 5, 4x4_1000 none.
[[nodiscard]] int correctable_bits(Family family);

/// The codes of some families, found by what a quad shows any way up, wrong bits included. All four
/// turns of every code are kept, sorted into buckets by pieces of the code. With c bits to be
/// corrected, and pieces that are searched with r₁, r₂ … flipped bits each, every code that is near
/// enough is met where Σ (rᵢ + 1) > c (Norouzi, Punjani and Fleet, "Fast search in Hamming space
/// with multi-index hashing", CVPR 2012). Looking one up takes some hundred comparisons at most,
/// whether a family has 30 codes or 65,535. Tables that are there at a time share what they hold.
class CodeTable {
 public:
  explicit CodeTable(std::span<const Family> families);

  /// Where cells are, in all families of the table; each once.
  [[nodiscard]] std::span<const MarkerLayout* const> layouts() const { return layouts_; }

  /// Appends the nearest marker of each family of the layout (one of layouts()), where one is as
  /// near as its family corrects. Bit i of `code` is set where cell i of the layout is white, its
  /// rows running down from the quad's first corner, its columns to the second.
  void find(const MarkerLayout& layout, std::uint64_t code, std::vector<CodeMatch>& matches) const;

 private:
  /// Codes by the value of `length` bits from `first` on.
  struct Piece {
    int first = 0;
    int length = 0;
    int flipped = 0;                    ///< bits that may be wrong in it
    std::vector<std::uint32_t> ends;    ///< by bucket: the end of its codes
    std::vector<std::uint64_t> codes;   ///< bucket by bucket
    std::vector<std::uint32_t> places;  ///< of these: number · 4 + corners from the top left on
    [[nodiscard]] std::uint64_t value_in(std::uint64_t code) const;
    [[nodiscard]] std::size_t bucket(std::uint64_t value) const;
    void fill(std::span<const std::uint64_t> turned);
  };
  struct Codes {
    Family family;
    const MarkerLayout* layout;
    int corrected = 0;
    std::vector<Piece> pieces;
  };
  struct Nearest;
  [[nodiscard]] static Codes codes_of(Family family);
  [[nodiscard]] static std::shared_ptr<const Codes> shared_codes(Family family);
  static void look(const Piece& piece, std::uint64_t code, std::uint64_t value, int from, int flips,
                   Nearest& nearest);

  std::vector<std::shared_ptr<const Codes>> families_;
  std::vector<const MarkerLayout*> layouts_;
};

}  // namespace waymark
