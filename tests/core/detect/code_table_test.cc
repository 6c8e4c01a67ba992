#include "core/detect/code_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "core/marker/marker_codes.h"

namespace waymark {
namespace {

/// The code as seen when the quad's corner `turn` is the marker's top left.
std::uint64_t code_of(const MarkerId& id, int turn) {
  const MarkerLayout& layout = marker_layout(id.family);
  const std::vector<CellPlace>& cells = layout.code();
  const std::uint64_t upright = marker_code(id);
  std::uint64_t code = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    CellPlace cell = cells[i];
    for (int k = 0; k < turn; ++k) {
      // The quad's first corner is one before: its rows are the marker's columns from the right.
      cell = {layout.square_cells() - 1 - cell.column, cell.row};
    }
    const auto index = std::find(cells.begin(), cells.end(), cell) - cells.begin();
    code |= (upright >> index & 1U) << i;
  }
  return code;
}

std::vector<CodeMatch> matches_of(const CodeTable& table, Family family, std::uint64_t code) {
  std::vector<CodeMatch> matches;
  table.find(marker_layout(family), code, matches);
  return matches;
}

/// Every id of a small family, and some of a large one.
int step_of(Family family) { return std::max(1, traits(family).id_count / 1500); }

class EveryFamily : public ::testing::TestWithParam<Family> {};

TEST_P(EveryFamily, EveryMarkerIsFoundAnyWayUpWithAsManyWrongBitsAsAreCorrected) {
  const Family family = GetParam();
  const CodeTable table({&family, 1});
  const int bits = traits(family).code_bits;
  std::mt19937 generator(3);
  std::vector<int> order(static_cast<std::size_t>(bits));
  for (int number = 0; number < traits(family).id_count; number += step_of(family)) {
    const int turn = number % 4;
    for (int i = 0; i < bits; ++i) order[static_cast<std::size_t>(i)] = i;
    std::shuffle(order.begin(), order.end(), generator);
    std::uint64_t code = code_of({family, number}, turn);
    for (int wrong = 0; wrong <= correctable_bits(family); ++wrong) {
      if (wrong > 0) code ^= std::uint64_t{1} << order[static_cast<std::size_t>(wrong - 1)];
      const auto matches = matches_of(table, family, code);
      ASSERT_EQ(matches.size(), 1U) << number << ' ' << wrong;
      ASSERT_EQ(matches[0].wrong_bits, wrong);
      ASSERT_EQ(matches[0].marker, (MarkerId{family, number}));
      ASSERT_EQ(matches[0].turn, turn);
    }
  }
}

TEST_P(EveryFamily, OfRandomCellsTheNearestCodeIsFoundIfAny) {
  const Family family = GetParam();
  const CodeTable table({&family, 1});
  std::vector<std::uint64_t> codes;
  for (int number = 0; number < traits(family).id_count; ++number) {
    for (int turn = 0; turn < 4; ++turn) codes.push_back(code_of({family, number}, turn));
  }
  std::mt19937_64 generator(5);
  for (int trial = 0; trial < 2'000'000 / static_cast<int>(1000 + codes.size()); ++trial) {
    const std::uint64_t code = generator() >> (64 - traits(family).code_bits);
    int nearest = 64;
    for (const std::uint64_t one : codes) nearest = std::min(nearest, std::popcount(code ^ one));
    const auto matches = matches_of(table, family, code);
    ASSERT_EQ(matches.empty(), nearest > correctable_bits(family));
    if (!matches.empty()) {
      ASSERT_EQ(matches[0].wrong_bits, nearest);
    }
  }
}

std::vector<Family> families() {
  std::vector<Family> all;
  for (const FamilyTraits& family : all_families()) all.push_back(family.family);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Families, EveryFamily, ::testing::ValuesIn(families()),
                         [](const auto& info) { return std::string(name_of(info.param)); });

TEST(CorrectableBits, StaysWithinDistanceAndChance) {
  EXPECT_EQ(correctable_bits(Family::tag36h11), 3);
  EXPECT_EQ(correctable_bits(Family::aruco_4x4_1000), 0);
  EXPECT_EQ(correctable_bits(Family::aruco_original), 0);
  EXPECT_GE(correctable_bits(Family::aruco_6x6_250), 3);
  EXPECT_EQ(correctable_bits(Family::tagstandard52h13), 5);
  EXPECT_EQ(correctable_bits(Family::aruco_mip_36h12), 4);
  for (const FamilyTraits& family : all_families()) {
    EXPECT_LE(correctable_bits(family.family), std::max(0, (family.distance - 1) / 2))
        << family.name;
  }
}

TEST(CodeTable, SeveralFamiliesOfOneSizeEachHaveTheirSay) {
  const std::vector<Family> both{Family::aruco_4x4_50, Family::aruco_4x4_1000, Family::tag36h11};
  const CodeTable table(both);
  EXPECT_EQ(table.layouts().size(), 2U);
  const auto matches =
      matches_of(table, Family::aruco_4x4_50, code_of({Family::aruco_4x4_50, 7}, 0));
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].marker, (MarkerId{Family::aruco_4x4_50, 7}));
  EXPECT_EQ(matches[1].marker, (MarkerId{Family::aruco_4x4_1000, 7}));
}

}  // namespace
}  // namespace waymark
