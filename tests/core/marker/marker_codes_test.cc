#include "core/marker/marker_codes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <set>

#include "core/marker/marker_layout.h"

namespace waymark {
namespace {

/// What the next corner's side shows.
std::uint64_t turned(std::uint64_t code, const MarkerLayout& layout) {
  const auto& cells = layout.code();
  std::uint64_t result = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellPlace seen{cells[i].column, layout.square_cells() - 1 - cells[i].row};
    const auto k = std::find(cells.begin(), cells.end(), seen) - cells.begin();
    result |= (code >> k & 1U) << i;
  }
  return result;
}

/// Fewest cells in which two markers differ, any way up.
int distance_of(const FamilyTraits& family) {
  const MarkerLayout& layout = marker_layout(family.family);
  std::vector<std::uint64_t> codes;
  for (int number = 0; number < family.id_count; ++number) {
    codes.push_back(marker_code({family.family, number}));
  }
  int least = family.code_bits;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    std::uint64_t code = codes[i];
    for (int turn = 0; turn < 4; ++turn, code = turned(code, layout)) {
      for (std::size_t k = i; k < codes.size(); ++k) {
        if (k == i && turn == 0) continue;
        least = std::min(least, std::popcount(code ^ codes[k]));
      }
    }
  }
  return least;
}

TEST(MarkerCodes, LieAsFarApartAsTheirFamilySays) {
  for (const FamilyTraits& family : all_families()) {
    if (family.id_count > 2500) continue;  // minutes
    EXPECT_EQ(distance_of(family), family.distance) << family.name;
  }
}

TEST(MarkerCodes, OfManyIdsAreAllDifferentAndWithinTheirBits) {
  for (const FamilyTraits& family : all_families()) {
    std::set<std::uint64_t> codes;
    for (int number = 0; number < family.id_count; ++number) {
      const std::uint64_t code = marker_code({family.family, number});
      EXPECT_EQ(code >> family.code_bits, 0U);
      codes.insert(code);
    }
    EXPECT_EQ(codes.size(), static_cast<std::size_t>(family.id_count)) << family.name;
  }
}

TEST(MarkerCodes, ThoseOfArucoMipAreItsAuthors) {
  // The first two and the last one of their table: the most significant of 36 bits is the top left.
  const auto as_published = [](int number) {
    const std::uint64_t code = marker_code({Family::aruco_mip_36h12, number});
    std::uint64_t published = 0;
    for (int i = 0; i < 36; ++i) published |= (code >> i & 1U) << (35 - i);
    return published;
  };
  EXPECT_EQ(as_published(0), 0xd2b63a09dU);
  EXPECT_EQ(as_published(1), 0x6001134e5U);
  EXPECT_EQ(as_published(249), 0x4d58dbea0U);
}

TEST(MarkerCodesDeathTest, NumberOutsideTheFamilyIsABug) {
  EXPECT_DEATH((void)marker_code({Family::tag16h5, 30}), "internal check failed");
  EXPECT_DEATH((void)marker_code({Family::tag16h5, -1}), "internal check failed");
}

}  // namespace
}  // namespace waymark
