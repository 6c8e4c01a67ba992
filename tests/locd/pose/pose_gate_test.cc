#include "locd/pose/pose_gate.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

using std::chrono::milliseconds;

PoseSolution good() {
  PoseSolution solution;
  solution.covariance = 1e-6 * Matrix6d::Identity();  // 1 mm, 1 mrad
  solution.inliers = 4;
  solution.inlier_markers = 4;
  return solution;
}

MotionPrediction sure_prior() {
  MotionPrediction prior;
  prior.covariance = 1e-6 * Matrix6d::Identity();
  return prior;
}

ReasonBits judge_alone(const PoseSolution& solution,
                       const std::optional<MotionPrediction>& prior = std::nullopt) {
  PoseGate gate{GateOptions{}};
  return gate.judge(milliseconds(0), solution, prior);
}

TEST(PoseGate, NothingIsWrongWithAGoodPose) { EXPECT_EQ(judge_alone(good()), 0U); }

TEST(PoseGate, ThreeSigmaUpToTheLimits) {
  const GateOptions options;
  for (const double factor : {0.99, 1.01}) {
    PoseSolution wide = good();
    wide.covariance(1, 1) = std::pow(factor * options.max_3sigma_m / 3, 2);
    EXPECT_EQ(judge_alone(wide) != 0, factor > 1);
    PoseSolution turned = good();
    turned.covariance(5, 5) = std::pow(factor * options.max_3sigma_rad / 3, 2);
    EXPECT_EQ(judge_alone(turned) != 0, factor > 1);
  }
  PoseSolution nan = good();
  nan.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(judge_alone(nan) & bit(PoseReason::sigma), 0U);
}

TEST(PoseGate, TheWorstDirectionCountsNotTheAxes) {
  PoseSolution skewed = good();
  const GateOptions options;
  const double variance = std::pow(0.8 * options.max_3sigma_m / 3, 2);
  skewed.covariance(0, 0) = skewed.covariance(1, 1) = variance;
  skewed.covariance(0, 1) = skewed.covariance(1, 0) = 0.9 * variance;
  EXPECT_EQ(judge_alone(skewed), bit(PoseReason::sigma));
}

TEST(PoseGate, OneMarkerNeedsAPriorThatAgrees) {
  PoseSolution one = good();
  one.inlier_markers = 1;
  EXPECT_EQ(judge_alone(one), bit(PoseReason::few_markers));
  EXPECT_EQ(judge_alone(one, sure_prior()), 0U);
  MotionPrediction elsewhere = sure_prior();
  elsewhere.world_from_rig.translation.x() = 0.05;
  EXPECT_EQ(judge_alone(one, elsewhere), bit(PoseReason::few_markers));
  MotionPrediction vague = sure_prior();
  vague.covariance *= 1e4;
  EXPECT_EQ(judge_alone(one, vague), bit(PoseReason::few_markers));
}

TEST(PoseGate, OutliersMustBeTheMinority) {
  PoseSolution doubtful = good();
  doubtful.outlier_markers = 3;
  EXPECT_EQ(judge_alone(doubtful), 0U);
  doubtful.outlier_markers = 4;
  EXPECT_EQ(judge_alone(doubtful), bit(PoseReason::outliers));
}

TEST(PoseGate, AJumpIsOneAndIsBelievedWhenItStays) {
  const GateOptions options;
  PoseGate gate(options);
  ASSERT_EQ(gate.judge(milliseconds(0), good(), std::nullopt), 0U);
  // 3 m/s for 0.1 s, and three times both sigmas of 1 mm.
  PoseSolution next = good();
  next.world_from_rig.translation.x() = 0.305;
  EXPECT_EQ(gate.judge(milliseconds(100), next, std::nullopt), 0U);
  PoseSolution far = good();
  far.world_from_rig.translation.x() = 5;
  Stamp now = milliseconds(100);
  for (int i = 1; i <= options.sets_to_believe_jump; ++i) {
    now += milliseconds(100);
    EXPECT_EQ(gate.judge(now, far, std::nullopt) != 0, i < options.sets_to_believe_jump) << i;
  }
  EXPECT_EQ(gate.resets(), 1);
  PoseSolution turned = far;
  turned.world_from_rig.rotation = so3_exp({0, 0, 1});
  now += milliseconds(100);
  EXPECT_EQ(gate.judge(now, turned, std::nullopt), bit(PoseReason::jump));
  gate.forget();
  EXPECT_EQ(gate.judge(now + milliseconds(100), turned, std::nullopt), 0U);
  EXPECT_EQ(gate.resets(), 2);
}

/// The vehicle drives on at 1 m/s past a place whose markers hang a second time 30 m away.
TEST(PoseGate, ATwinOfAPlaceIsLeftAgainWhereTheVehicleDroveMeanwhile) {
  PoseGate gate{GateOptions{}};
  for (int i = 0; i < 60; ++i) {
    const bool twin = i >= 10 && i < 40;
    PoseSolution here = good();
    here.world_from_rig.translation.x() = 0.1 * i + (twin ? 30 : 0);
    EXPECT_EQ(gate.judge(milliseconds(100 * i), here, std::nullopt) != 0, twin) << i;
  }
  EXPECT_EQ(gate.resets(), 0);
}

TEST(PoseGate, OutliersThatAgreeOnAnotherPoseMakeItAmbiguous) {
  PoseSolution two = good();
  two.rivals = true;
  EXPECT_EQ(judge_alone(two), bit(PoseReason::ambiguous));
}

TEST(PoseGate, NoPriorVouchesForAMinority) {
  PoseSolution doubtful = good();
  doubtful.outlier_markers = doubtful.inlier_markers;
  EXPECT_EQ(judge_alone(doubtful, sure_prior()), bit(PoseReason::outliers));
}

TEST(PoseGate, OneFarPoseDoesNotBecomeThePlace) {
  PoseGate gate{GateOptions{}};
  ASSERT_EQ(gate.judge(milliseconds(0), good(), std::nullopt), 0U);
  PoseSolution far = good();
  far.world_from_rig.translation.x() = 5;
  EXPECT_EQ(gate.judge(milliseconds(100), far, std::nullopt), bit(PoseReason::jump));
  EXPECT_EQ(gate.judge(milliseconds(200), good(), std::nullopt), 0U);
}

TEST(PoseGate, AmbiguousIsSaid) {
  PoseSolution two = good();
  two.ambiguous = true;
  EXPECT_EQ(judge_alone(two), bit(PoseReason::ambiguous));
}

TEST(GateOptions, AreHeldToTheirRanges) {
  using Options = GateOptions;
  expect_ranges<Options>(
      {ranged("max_3sigma_m", &Options::max_3sigma_m, Options::kMax3Sigma_m),
       ranged("max_protection_m", &Options::max_protection_m, Options::kMaxProtection_m),
       ranged("v_max_mps", &Options::v_max_mps, Options::kVMax_mps),
       ranged("vouching_factor", &Options::vouching_factor, Options::kVouchingFactor),
       ranged("sets_to_believe_jump", &Options::sets_to_believe_jump,
              Options::kSetsToBelieveJump)});
}

}  // namespace
}  // namespace waymark
