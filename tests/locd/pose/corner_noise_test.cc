#include "locd/pose/corner_noise.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

/// A camera's markers with so much noise; `share` of them are no squares.
class Noise : public testing::Test {
 protected:
  void see(double noise_px, int markers, double stated_px = 0, double share = 0) {
    for (int m = 0; m < markers; ++m) {
      SetObservation o;
      o.observation.size_m = 0.3;
      const Rigid3 cam_from_marker{so3_exp({M_PI, 0.5 * normal_(random_), 0.3 * normal_(random_)}),
                                   {0.8 * normal_(random_), 0.5 * normal_(random_), 4}};
      const auto x = marker_corners(0.3);
      for (std::size_t i = 0; i < 4; ++i) {
        const auto pixel = model_.project(cam_from_marker * x[i]);
        if (!pixel) return;
        o.detected_px[i] = *pixel + noise_px * Eigen::Vector2d(normal_(random_), normal_(random_));
      }
      if (std::uniform_real_distribution<double>()(random_) < share) o.detected_px[2].x() += 30;
      o.observation.corners_px = o.detected_px;
      o.stated.fill(stated_px * stated_px * Eigen::Matrix2d::Identity());
      const auto left = left_by_own_pose(o, model_, std::nullopt, noise_.sigma_px());
      if (left) noise_.add(*left);
    }
    noise_.update();
  }

  CameraModel model_ = test::ring_rig(1).cameras[0].model;
  CornerNoise noise_;
  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
};

TEST_F(Noise, IsFoundWithoutAPoseOfTheRig) {
  noise_.begin(false);
  for (int i = 0; i < 60; ++i) see(0.2, 6);
  EXPECT_NEAR(noise_.sigma_px(), 0.2, 0.03);
}

TEST_F(Noise, OfWhatTheDetectorStatesIsNotCountedTwice) {
  noise_.begin(true);
  for (int i = 0; i < 60; ++i) see(0.1, 6, 0.1);
  EXPECT_LT(noise_.sigma_px(), 0.05);
  EXPECT_NEAR(noise_.total_px(), 0.1, 0.02);
}

TEST_F(Noise, FollowsWithinFiftySetsBothWaysAndSaysSo) {
  noise_.begin(true);
  for (int i = 0; i < 100; ++i) see(0.1, 6, 0.1);
  EXPECT_FALSE(noise_.unusual());
  for (const double factor : {3.0, 10.0, 30.0}) {
    for (int i = 0; i < 50; ++i) see(0.1 * factor, 6, 0.1);
    EXPECT_NEAR(noise_.total_px() / (0.1 * factor), 1, 0.2) << factor;
    EXPECT_EQ(noise_.unusual(), factor > 5) << factor;
    for (int i = 0; i < 50; ++i) see(0.1, 6, 0.1);
    EXPECT_NEAR(noise_.total_px(), 0.1, 0.02) << factor;
    EXPECT_FALSE(noise_.unusual()) << factor;
  }
}

TEST_F(Noise, IsToldWhereNearlyHalfOfTheMarkersAreWrong) {
  noise_.begin(true);
  for (int i = 0; i < 60; ++i) see(0.1, 6, 0.1, 0.4);
  EXPECT_NEAR(noise_.total_px(), 0.1, 0.04);
}

}  // namespace
}  // namespace waymark
