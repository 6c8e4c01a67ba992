#include "locd/pose/motion_filter.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;

MotionEvidence seen_at(const Rigid3& pose, double sigma) {
  MotionEvidence evidence;
  evidence.world_from_rig = pose;
  evidence.of_pose = Matrix6d::Identity() / (sigma * sigma);
  return evidence;
}

/// 1 m/s along x, 0.3 rad/s about z.
Rigid3 driving(double time_s) { return {so3_exp({0, 0, 0.3 * time_s}), {time_s, 2, 0}}; }

TEST(MotionFilter, LearnsTheVelocityAndPredicts) {
  MotionFilter filter(MotionOptions{});
  EXPECT_FALSE(filter.predict(milliseconds(0)));
  for (int i = 0; i <= 30; ++i) {
    filter.update(milliseconds(33 * i), seen_at(driving(0.033 * i), 1e-4));
    const auto now = filter.predict(milliseconds(33 * i));
    ASSERT_TRUE(now);
    EXPECT_EQ(now->velocity_known, i >= 1);
  }
  const auto next = filter.predict(milliseconds(33 * 31));
  ASSERT_TRUE(next);
  Vector6d velocity;
  velocity << 1, 0, 0, 0, 0, 0.3;
  EXPECT_LT((next->velocity - velocity).norm(), 0.01);
  EXPECT_LT(next->world_from_rig.minus(driving(0.033 * 31)).norm(), 1e-3);
  EXPECT_GT(next->covariance(0, 0), 0);
}

TEST(MotionFilter, AGapMakesItStartAnew) {
  MotionOptions options;
  options.max_age_s = 0.5;
  MotionFilter filter(options);
  filter.update(milliseconds(0), seen_at(driving(0), 1e-4));
  filter.update(milliseconds(100), seen_at(driving(0.1), 1e-4));
  EXPECT_TRUE(filter.predict(milliseconds(600)));
  EXPECT_FALSE(filter.predict(milliseconds(601)));
  EXPECT_FALSE(filter.predict(milliseconds(99))) << "a stamp before the last";
  filter.update(milliseconds(700), seen_at(driving(0.7), 1e-4));
  EXPECT_FALSE(filter.predict(milliseconds(700))->velocity_known);
  filter.reset();
  EXPECT_FALSE(filter.predict(milliseconds(700)));
}

TEST(MotionFilter, CornersOfOtherInstantsTellTheVelocityAtOnce) {
  MotionFilter filter(MotionOptions{});
  // One set whose parts lie 10 ms before and after its stamp; the rig moves at 0.5 m/s along x.
  MotionEvidence evidence = seen_at({}, 1e-4);
  const double information = 1.0 / (1e-4 * 1e-4);
  evidence.of_velocity = 1e-4 * information * Matrix6d::Identity();
  evidence.towards_velocity[0] = 1e-4 * information * 0.5;
  filter.update(milliseconds(0), evidence);
  const auto now = filter.predict(milliseconds(0));
  ASSERT_TRUE(now);
  EXPECT_NEAR(now->velocity[0], 0.5, 1e-3);
  EXPECT_NEAR(now->velocity[1], 0.0, 1e-9);
}

TEST(MotionOptions, AreHeldToTheirRanges) {
  expect_ranges<MotionOptions>(
      {ranged("max_age_s", &MotionOptions::max_age_s, MotionOptions::kMaxAge_s),
       ranged("speed_sigma_mps", &MotionOptions::speed_sigma_mps, {0.05, 20}),
       ranged("turn_sigma_radps", &MotionOptions::turn_sigma_radps, {0.05, 20}),
       ranged("accel_density", &MotionOptions::accel_density, {0.01, 100}),
       ranged("turn_accel_density", &MotionOptions::turn_accel_density, {0.01, 100})});
}

}  // namespace
}  // namespace waymark
