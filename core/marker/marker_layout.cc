#include "core/marker/marker_layout.h"

#include <array>
#include <string>

#include "core/base/check.h"

namespace waymark {
namespace {

using Picture = std::span<const std::string_view>;

constexpr std::array<std::string_view, 9> kStandard41{"ccccccccc",  //
                                                      "c.......c",  //
                                                      "c.#####.c",  //
                                                      "c.#ccc#.c",  //
                                                      "c.#ccc#.c",  //
                                                      "c.#ccc#.c",  //
                                                      "c.#####.c",  //
                                                      "c.......c",  //
                                                      "ccccccccc"};

constexpr std::array<std::string_view, 10> kStandard52{"cccccccccc",  //
                                                       "c........c",  //
                                                       "c.######.c",  //
                                                       "c.#cccc#.c",  //
                                                       "c.#cccc#.c",  //
                                                       "c.#cccc#.c",  //
                                                       "c.#cccc#.c",  //
                                                       "c.######.c",  //
                                                       "c........c",  //
                                                       "cccccccccc"};

constexpr std::array<std::string_view, 10> kCustom48{"cccccccccc",  //
                                                     "c........c",  //
                                                     "c.######.c",  //
                                                     "c.#cccc#.c",  //
                                                     "c.#c..c#.c",  //
                                                     "c.#c..c#.c",  //
                                                     "c.#cccc#.c",  //
                                                     "c.######.c",  //
                                                     "c........c",  //
                                                     "cccccccccc"};

constexpr std::array<std::string_view, 9> kCircle21{"   ccc   ",  //
                                                    " ....... ",  //
                                                    " .#####. ",  //
                                                    "c.#ccc#.c",  //
                                                    "c.#ccc#.c",  //
                                                    "c.#ccc#.c",  //
                                                    " .#####. ",  //
                                                    " ....... ",  //
                                                    "   ccc   "};

constexpr std::array<std::string_view, 11> kCircle49{"    ccc    ",  //
                                                     "  ccccccc  ",  //
                                                     " c.......c ",  //
                                                     " c.#####.c ",  //
                                                     "cc.#ccc#.cc",  //
                                                     "cc.#ccc#.cc",  //
                                                     "cc.#ccc#.cc",  //
                                                     " c.#####.c ",  //
                                                     " c.......c ",  //
                                                     "  ccccccc  ",  //
                                                     "    ccc    "};

/// A code of `side`² cells in a black border.
MarkerLayout bordered(int side) {
  const auto cells = static_cast<std::size_t>(side);
  const std::string edge(cells + 2, '.');
  const std::string inside = "." + std::string(cells, 'c') + ".";
  std::vector<std::string_view> picture(cells + 2, inside);
  picture.front() = picture.back() = edge;
  return {picture, side + 2};
}

MarkerLayout layout_of(const FamilyTraits& family) {
  switch (family.family) {
    case Family::tagstandard41h12:
      return {kStandard41, 5};
    case Family::tagstandard52h13:
      return {kStandard52, 6};
    case Family::tagcustom48h12:
      return {kCustom48, 6};
    case Family::tagcircle21h7:
      return {kCircle21, 5};
    case Family::tagcircle49h12:
      return {kCircle49, 5};
    default:
      break;
  }
  int side = 1;
  while (side * side < family.code_bits) ++side;
  return bordered(side);
}

CellKind kind_of(char drawn) {
  switch (drawn) {
    case '.':
      return CellKind::black;
    case '#':
      return CellKind::white;
    case 'c':
      return CellKind::code;
    default:
      return CellKind::nothing;
  }
}

std::vector<MarkerLayout> all_layouts() {
  std::vector<MarkerLayout> layouts;
  for (const FamilyTraits& family : all_families()) {
    layouts.push_back(layout_of(family));
    WAYMARK_CHECK(layouts.back().code().size() == static_cast<std::size_t>(family.code_bits));
    WAYMARK_CHECK(layouts.back().square_cells() <= kMaxSquareCells);
    WAYMARK_CHECK(layouts.back().all_cells() <= kMaxMarkerCells);
  }
  return layouts;
}

}  // namespace

MarkerLayout::MarkerLayout(Picture picture, int square_cells)
    : square_cells_(square_cells),
      outside_cells_((static_cast<int>(picture.size()) - square_cells) / 2) {
  WAYMARK_CHECK(picture.size() == static_cast<std::size_t>(all_cells()));
  for (std::size_t row = 0; row < picture.size(); ++row) {
    WAYMARK_CHECK(picture[row].size() == picture.size());
    for (std::size_t column = 0; column < picture.size(); ++column) {
      kinds_.push_back(kind_of(picture[row][column]));
      if (kinds_.back() != CellKind::code) continue;
      code_.push_back(
          {static_cast<int>(row) - outside_cells_, static_cast<int>(column) - outside_cells_});
    }
  }
}

const MarkerLayout& marker_layout(Family family) {
  static const std::vector<MarkerLayout> layouts = all_layouts();
  return layouts.at(static_cast<std::size_t>(family));
}

}  // namespace waymark
