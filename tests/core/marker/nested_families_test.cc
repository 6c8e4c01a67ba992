#include "core/marker/nested_families.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/marker/marker_bits.h"

namespace waymark {
namespace {

TEST(NestedFamilies, ThoseThatShareCodesBeginAlikeAndOthersDoNot) {
  const auto begin_alike = [](Family a, Family b) {
    if (marker_layout(a) != marker_layout(b)) return false;
    for (int number = 0; number < std::min(traits(a).id_count, traits(b).id_count); ++number) {
      if (marker_bits({a, number}).white != marker_bits({b, number}).white) return false;
    }
    return true;
  };
  for (const FamilyTraits& a : all_families()) {
    for (const FamilyTraits& b : all_families()) {
      if (a.id_count > 100 && b.id_count > 100) continue;  // as alike, and slower to show
      EXPECT_EQ(share_codes(a.family, b.family), begin_alike(a.family, b.family))
          << a.name << " " << b.name;
    }
  }
}

TEST(NestedFamilies, TheSmallestThatHoldsANumber) {
  EXPECT_EQ(largest_beginning_with(Family::aruco_5x5_100), Family::aruco_5x5_1000);
  EXPECT_EQ(smallest_holding(Family::aruco_4x4_1000, 49), Family::aruco_4x4_50);
  EXPECT_EQ(smallest_holding(Family::aruco_4x4_1000, 50), Family::aruco_4x4_100);
  EXPECT_EQ(smallest_holding(Family::aruco_7x7_1000, 999), Family::aruco_7x7_1000);
  EXPECT_EQ(smallest_holding(Family::tag36h11, 3), Family::tag36h11);
}

}  // namespace
}  // namespace waymark
