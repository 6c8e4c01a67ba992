#include "core/detect/square_finder.h"

#include <gtest/gtest.h>

#include "tests/support/printed_wall.h"

namespace waymark {
namespace {

Eigen::Vector2d centre_of(const ImageCorners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

/// Twice the area, positive where the corners run clockwise in the image.
double turn_of(const ImageCorners& c) {
  const Eigen::Vector2d across = c[2] - c[0];
  const Eigen::Vector2d down = c[3] - c[1];
  return across.x() * down.y() - across.y() * down.x();
}

/// How many of the wall's eight prints have a square about their middle, of
/// about this side.
int found_of(const std::vector<ImageCorners>& squares, double side_px) {
  int found = 0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d middle(90.0 + 150.0 * (i % 4), 130.0 + 210.0 * (i / 4));
    for (const ImageCorners& square : squares) {
      if ((centre_of(square) - middle).norm() > 4) continue;
      if (std::abs((square[1] - square[0]).norm() - side_px) > 0.15 * side_px) continue;
      EXPECT_GT(turn_of(square), 0);
      ++found;
      break;
    }
  }
  return found;
}

TEST(SquareFinder, FindsPrintsThatNoDictionaryReads) {
  for (const double border_cells : {0.5, 1.0, 2.0}) {
    test::Print print;
    print.border_cells = border_cells;
    EXPECT_EQ(found_of(find_squares(test::wall_with(print, 0).view()), print.side_px), 8);
  }
}

TEST(SquareFinder, FindsNothingOnABareWallOrInAnImageOfNoSize) {
  test::Print bare;
  bare.numbers = {};
  EXPECT_TRUE(find_squares(test::wall_with(bare, 0).view()).empty());
  EXPECT_TRUE(find_squares(GrayImage(3, 3).view()).empty());
}

TEST(SquareFinder, CodeAreasAreFoundWithoutAnOutline) {
  test::Print print;
  print.margin_cells = 0;
  print.wall = print.black;
  const auto areas = find_code_areas(test::wall_with(print, 0).view());
  // Codes whose rim has white cells on all four sides; most have.
  EXPECT_GE(found_of(areas, print.side_px * 6 / 8), 4);
}

}  // namespace
}  // namespace waymark
