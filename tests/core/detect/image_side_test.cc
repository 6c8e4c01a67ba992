#include "core/detect/image_side.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

class ImageSides : public testing::Test {
 protected:
  [[nodiscard]] std::optional<ImageSide> side(const Eigen::Vector2d& start,
                                              const Eigen::Vector2d& end, double bow_px) const {
    return ImageSide::create(plane_, *plane_.plane_from_pixel(start), *plane_.plane_from_pixel(end),
                             bow_px);
  }

  CameraModel camera_ = test::ring_rig(1).cameras[0].model;  // no distortion
  MarkerPlane plane_{camera_, Eigen::Vector3d::UnitZ()};
};

TEST_F(ImageSides, WithoutDistortionIsItsChord) {
  const auto top = side({500, 400}, {700, 400}, 0);
  ASSERT_TRUE(top);
  EXPECT_NEAR(top->length_px(), 200, 1e-8);
  EXPECT_LT((top->end_px() - Eigen::Vector2d(700, 400)).norm(), 1e-8);
  EXPECT_NEAR(top->place({550, 380}), 0.25, 1e-10);
  EXPECT_NEAR(top->outside_px({550, 380}), 20, 1e-8) << "above the top side is outside";
  for (const double place : {0.1, 0.5, 0.9}) EXPECT_NEAR(top->bend_px(place), 0, 1e-8);
}

TEST_F(ImageSides, ABowLiesOutsideInTheMiddle) {
  const auto top = side({500, 400}, {700, 400}, 3);
  ASSERT_TRUE(top);
  EXPECT_NEAR(top->bend_px(0.5), 3, 1e-8);
  EXPECT_NEAR(top->bend_px(0), 0, 1e-12);
  EXPECT_NEAR(top->bend_px(1), 0, 1e-12);
  EXPECT_NEAR(top->point_px(0.5).y(), 397, 1e-8);
  constexpr double kStep = 1e-6;
  for (const double place : {0.2, 0.5, 0.7}) {
    const double slope = (top->bend_px(place + kStep) - top->bend_px(place - kStep)) / (2 * kStep);
    EXPECT_NEAR(top->bend_slope_px(place), slope, 1e-6);
  }
}

TEST_F(ImageSides, ShorterThanAPixelIsNone) {
  EXPECT_FALSE(side({500, 400}, {500.9, 400}, 0));
  EXPECT_TRUE(side({500, 400}, {501.1, 400}, 0));
}

}  // namespace
}  // namespace waymark
