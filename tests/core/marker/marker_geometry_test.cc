#include "core/marker/marker_geometry.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(MarkerCorners, RunFromTopLeftClockwiseAsSeenFromTheFront) {
  const auto corners = marker_corners(0.3);
  EXPECT_EQ(corners[static_cast<int>(Corner::top_left)], Eigen::Vector3d(-0.15, 0.15, 0));
  EXPECT_EQ(corners[static_cast<int>(Corner::top_right)], Eigen::Vector3d(0.15, 0.15, 0));
  EXPECT_EQ(corners[static_cast<int>(Corner::bottom_right)], Eigen::Vector3d(0.15, -0.15, 0));
  EXPECT_EQ(corners[static_cast<int>(Corner::bottom_left)], Eigen::Vector3d(-0.15, -0.15, 0));
}

}  // namespace
}  // namespace waymark
