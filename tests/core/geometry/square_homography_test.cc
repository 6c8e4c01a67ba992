#include "core/geometry/square_homography.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

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

TEST(SquareHomography, OfThreeCornersOnALineThereIsNoneAtAnyScaleAndPlace) {
  const std::array<Eigen::Vector2d, 4> all{{{10, 10}, {50, 50}, {90, 90}, {130, 130}}};
  for (const double scale : {1e-6, 1e-3, 1.0, 0.1, 1e3}) {
    for (std::size_t apart = 0; apart <= 4; ++apart) {
      std::array<Eigen::Vector2d, 4> quad = all;
      if (apart < 4) quad[apart] += Eigen::Vector2d(30, -7);
      for (Eigen::Vector2d& corner : quad) corner = scale * (corner + Eigen::Vector2d(0.3, 0.7));
      EXPECT_FALSE(homography_from_unit_square(quad)) << scale << " " << apart;
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(homography_from_unit_square({{{0, 0}, {1, nan}, {1, 1}, {0, 1}}}));
}

TEST(SquareHomography, ASmallOrNarrowQuadHasOne) {
  for (const double scale : {1e-9, 1e-3, 1.0, 1e6}) {
    for (const double narrow : {1e-6, 1.0}) {
      EXPECT_TRUE(homography_from_unit_square(
          {{{0, 0}, {scale, 0}, {scale, narrow * scale}, {0.1 * scale, 1.1 * narrow * scale}}}));
    }
  }
}

}  // namespace
}  // namespace waymark
