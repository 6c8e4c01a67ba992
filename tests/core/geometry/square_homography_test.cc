#include "core/geometry/square_homography.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace waymark {
namespace {

TEST(SquareHomography, LeadsTheUnitSquaresCornersToTheQuad) {
  const std::array<Eigen::Vector2d, 4> quad{{{10, 20}, {110, 30}, {95, 140}, {5, 90}}};
  const auto h = homography_from_unit_square(quad);
  ASSERT_TRUE(h);
  EXPECT_EQ((*h)(2, 2), 1);
  const std::array<Eigen::Vector2d, 4> unit{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d there = (*h * unit[i].homogeneous()).hnormalized();
    EXPECT_LT((there - quad[i]).norm(), 1e-12 * quad[i].norm() + 1e-12) << i;
  }
  // A homography keeps lines: the middle is where the diagonals meet.
  const Eigen::Vector2d middle = (*h * Eigen::Vector3d(0.5, 0.5, 1)).hnormalized();
  const Eigen::Vector2d ac = quad[2] - quad[0];
  const Eigen::Vector2d to_middle = middle - quad[0];
  EXPECT_NEAR(ac.x() * to_middle.y() - ac.y() * to_middle.x(), 0, 1e-9);
}

TEST(SquareHomography, OfCornersOnALineThereIsNone) {
  const std::array<Eigen::Vector2d, 4> on_a_line{{{0, 0}, {1, 1}, {2, 2}, {3, 3}}};
  EXPECT_FALSE(homography_from_unit_square(on_a_line));
}

}  // namespace
}  // namespace waymark
