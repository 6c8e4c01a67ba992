#include "core/marker/marker_layout.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace waymark {
namespace {

TEST(MarkerLayout, EarlierFamiliesHaveTheirCodeInABlackBorder) {
  const MarkerLayout& layout = marker_layout(Family::tag36h11);
  EXPECT_EQ(layout.square_cells(), 8);
  EXPECT_EQ(layout.outside_cells(), 0);
  EXPECT_FALSE(layout.is_light());
  EXPECT_EQ(layout.at({0, 3}), CellKind::black);
  EXPECT_EQ(layout.at({7, 7}), CellKind::black);
  EXPECT_EQ(layout.code().front(), (CellPlace{1, 1}));
  EXPECT_EQ(layout.code().back(), (CellPlace{6, 6}));
}

TEST(MarkerLayout, LaterFamiliesHaveTheirCodeOnBothSidesOfARing) {
  const MarkerLayout& layout = marker_layout(Family::tagstandard41h12);
  EXPECT_EQ(layout.square_cells(), 5);
  EXPECT_EQ(layout.outside_cells(), 2);
  EXPECT_TRUE(layout.is_light());
  EXPECT_EQ(layout.at({0, 0}), CellKind::white);
  EXPECT_EQ(layout.at({-1, -1}), CellKind::black);
  EXPECT_EQ(layout.code().front(), (CellPlace{-2, -2}));
  EXPECT_EQ(layout.code().back(), (CellPlace{6, 6}));
}

TEST(MarkerLayout, RoundMarkersHaveNothingInTheirCorners) {
  EXPECT_EQ(marker_layout(Family::tagcircle21h7).at({-2, -2}), CellKind::nothing);
  EXPECT_EQ(marker_layout(Family::tagcircle21h7).at({-2, 1}), CellKind::code);
  EXPECT_EQ(marker_layout(Family::tagcircle49h12).outside_cells(), 3);
}

TEST(MarkerLayout, EveryFamilysLooksTheSameFromAllFourSides) {
  for (const FamilyTraits& family : all_families()) {
    const MarkerLayout& layout = marker_layout(family.family);
    for (int row = -layout.outside_cells(); row < layout.square_cells() + layout.outside_cells();
         ++row) {
      for (int column = -layout.outside_cells();
           column < layout.square_cells() + layout.outside_cells(); ++column) {
        EXPECT_EQ(layout.at({row, column}), layout.at({column, layout.square_cells() - 1 - row}))
            << family.name << ' ' << row << ' ' << column;
      }
    }
  }
}

TEST(MarkerLayout, IsOneForFamiliesOfAKind) {
  EXPECT_EQ(marker_layout(Family::tag36h11), marker_layout(Family::aruco_6x6_50));
  EXPECT_NE(marker_layout(Family::tag36h11), marker_layout(Family::aruco_5x5_50));
  EXPECT_NE(marker_layout(Family::tagstandard52h13), marker_layout(Family::tagcustom48h12));
}

}  // namespace
}  // namespace waymark
