#include "core/estimate/observation_weight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

TEST(ObservationWeight, IsTheFormulaOfEquation7) {
  const ObservationWeightOptions options;
  const double expected =
      std::exp(-1.0 * (3.0 / 15) * (3.0 / 15) - 5.0 * std::pow(0.7 / options.max_angle_rad, 2) +
               0.1 * std::exp(-0.25 * 0.25 / (2 * 0.01)));
  EXPECT_DOUBLE_EQ(observation_weight(3.0, 0.7, 0.25, options), expected);
}

TEST(ObservationWeight, FollowsTheSignsNotTheProse) {
  // The prose says that near, frontal and ambiguous observations weigh less; the formula says more.
  const ObservationWeightOptions options;
  EXPECT_GT(observation_weight(1, 0.5, 0.5, options), observation_weight(5, 0.5, 0.5, options));
  EXPECT_GT(observation_weight(1, 0.2, 0.5, options), observation_weight(1, 0.9, 0.5, options));
  EXPECT_GT(observation_weight(1, 0.5, 0.01, options), observation_weight(1, 0.5, 0.9, options));
}

TEST(ObservationWeight, WithoutLambdasAllWeighOne) {
  ObservationWeightOptions options;
  options.lambda_distance = options.lambda_angle = options.lambda_ambiguity = 0;
  EXPECT_DOUBLE_EQ(observation_weight(14, 1.5, 0, options), 1.0);
}

TEST(ObservationWeight, TakesDistanceAndAngleFromTheBetterSolution) {
  ObservationWeightOptions options;
  options.lambda_ambiguity = 0;
  IppeSolutions solutions;
  // Two metres ahead, its normal 60° off the ray back to the camera.
  const double tilt = M_PI / 3;
  solutions.cam_from_marker[0] = {so3_exp({0, M_PI - tilt, 0}), {0, 0, 2}};
  solutions.cam_from_marker[1] = {so3_exp({0, M_PI + tilt, 0}), {0, 0, 2}};
  EXPECT_NEAR(observation_weight(solutions, options), observation_weight(2.0, tilt, 1.0, options),
              1e-12);
}

TEST(ObservationWeightOptions, AreHeldToTheirRanges) {
  expect_ranges<ObservationWeightOptions>(
      {ranged("lambda_distance", &ObservationWeightOptions::lambda_distance,
              ObservationWeightOptions::kLambda),
       ranged("lambda_angle", &ObservationWeightOptions::lambda_angle,
              ObservationWeightOptions::kLambda),
       ranged("lambda_ambiguity", &ObservationWeightOptions::lambda_ambiguity,
              ObservationWeightOptions::kLambda),
       ranged("epsilon_rad", &ObservationWeightOptions::epsilon_rad,
              ObservationWeightOptions::kDivisor),
       ranged("max_distance_m", &ObservationWeightOptions::max_distance_m,
              ObservationWeightOptions::kDivisor),
       ranged("max_angle_rad", &ObservationWeightOptions::max_angle_rad,
              ObservationWeightOptions::kDivisor)});
}

}  // namespace
}  // namespace waymark
