#include "core/marker/marker_outline.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace waymark {
namespace {

TEST(MarkerOutline, MovesEverySideOutByOnePixel) {
  const ImageCorners quad{{{10, 10}, {60, 14}, {55, 70}, {8, 58}}};
  for (const bool mirrored : {false, true}) {
    ImageCorners corners = quad;
    if (mirrored) std::reverse(corners.begin(), corners.end());
    const auto outward = outward_of(corners);
    const Eigen::Vector2d centre = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d& a = corners[i];
      const Eigen::Vector2d& b = corners[(i + 1) % 4];
      Eigen::Vector2d normal = Eigen::Vector2d(b.y() - a.y(), a.x() - b.x()).normalized();
      if (normal.dot(a - centre) < 0) normal = -normal;
      EXPECT_NEAR(normal.dot(outward[i]), 1, 1e-12);
      EXPECT_NEAR(normal.dot(outward[(i + 1) % 4]), 1, 1e-12);
    }
  }
}

TEST(MarkerOutline, ASquareMovedInIsASmallerSquare) {
  ImageCorners corners{{{10, 10}, {50, 10}, {50, 50}, {10, 50}}};
  move_sides_in(0, corners);
  EXPECT_EQ(corners[0], Eigen::Vector2d(10, 10));
  move_sides_in(2, corners);
  EXPECT_LT((corners[0] - Eigen::Vector2d(12, 12)).norm(), 1e-12);
  EXPECT_LT((corners[2] - Eigen::Vector2d(48, 48)).norm(), 1e-12);
  move_sides_in(-2, corners);
  EXPECT_LT((corners[1] - Eigen::Vector2d(50, 10)).norm(), 1e-12);
}

TEST(MarkerOutline, HasACentreAndAMeanSide) {
  const ImageCorners corners{{{10, 10}, {50, 10}, {50, 30}, {10, 30}}};
  EXPECT_EQ(centre_of(corners), Eigen::Vector2d(30, 20));
  EXPECT_EQ(mean_side_px(corners), 30);
}

TEST(MarkerOutline, InsetIsByWhatSidesWereMovedIn) {
  const ImageCorners black{{{10, 12}, {60, 20}, {55, 70}, {8, 58}}};
  for (const bool mirrored : {false, true}) {
    ImageCorners outline = black;
    if (mirrored) std::reverse(outline.begin(), outline.end());
    for (const double px : {0.4, -0.3, 0.0}) {
      ImageCorners given = outline;
      move_sides_in(px, given);
      EXPECT_NEAR(inset_px(given, outline), px, 1e-12);
    }
  }
}

}  // namespace
}  // namespace waymark
