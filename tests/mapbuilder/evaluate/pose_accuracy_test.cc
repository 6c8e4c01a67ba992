#include "mapbuilder/evaluate/pose_accuracy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

const Rigid3 kEstimateFromTruth{so3_exp({0.4, -1.2, 2}), {5, -3, 8}};

/// True poses on the corners of a square of 2 m, each turned its own way.
std::vector<Rigid3> square() {
  return {{so3_exp({0, 0, 0}), {1, 1, 0}},
          {so3_exp({1, 0, 0}), {-1, 1, 0}},
          {so3_exp({0, 2, 0}), {-1, -1, 0}},
          {so3_exp({0, 1, 1}), {1, -1, 0}}};
}

std::vector<PosePair> seen_from_elsewhere(const std::vector<Rigid3>& truth,
                                          const std::vector<Rigid3>& estimate) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    pairs.push_back({kEstimateFromTruth * estimate[i], truth[i]});
  }
  return pairs;
}

std::vector<MarkerPair> as_markers(const std::vector<PosePair>& poses) {
  std::vector<MarkerPair> markers;
  for (const PosePair& pose : poses) markers.push_back({pose, 0.2});
  return markers;
}

TEST(PoseAccuracy, AnotherWorldFrameIsNoError) {
  const auto accuracy = accuracy_of_cameras(seen_from_elsewhere(square(), square()));
  ASSERT_TRUE(accuracy);
  EXPECT_FALSE(accuracy->positions_on_a_line);
  EXPECT_LT(accuracy->truth_from_estimate.minus(kEstimateFromTruth.inverse()).norm(), 1e-13);
  EXPECT_LT(accuracy->rmse.translation_m, 1e-14);
  EXPECT_LT(accuracy->rmse.rotation_rad, 1e-14);
  EXPECT_NEAR(accuracy->scale, 1, 1e-14);
  EXPECT_EQ(accuracy->each.size(), 4U);
}

TEST(PoseAccuracy, TwistAndTurnsThatNoMotionTakesAwayAreTheError) {
  std::vector<Rigid3> estimate = square();
  for (std::size_t i = 0; i < 4; ++i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    estimate[i].translation.z() += sign * 0.01;
    estimate[i].rotation = so3_exp({0, sign * 0.002, 0}) * estimate[i].rotation;
  }
  const auto accuracy = accuracy_of_cameras(seen_from_elsewhere(square(), estimate));
  ASSERT_TRUE(accuracy);
  EXPECT_NEAR(accuracy->rmse.translation_m, 0.01, 1e-12);
  EXPECT_NEAR(accuracy->rmse.rotation_rad, 0.002, 1e-12);
  // Umeyama: Σ truth·estimate / Σ |estimate|² = 8 / (8 + 4 · 0.01²).
  EXPECT_NEAR(accuracy->scale, 8 / 8.0004, 1e-12);
  for (const PoseError& error : accuracy->each) EXPECT_NEAR(error.translation_m, 0.01, 1e-12);
}

TEST(PoseAccuracy, ScaleCarriesTheEstimateOntoTheTruth) {
  std::vector<Rigid3> estimate = square();
  for (Rigid3& pose : estimate) pose.translation *= 1.01;
  const auto accuracy = accuracy_of_cameras(seen_from_elsewhere(square(), estimate));
  ASSERT_TRUE(accuracy);
  EXPECT_NEAR(accuracy->scale, 1 / 1.01, 1e-13);
  EXPECT_NEAR(accuracy->rmse.translation_m, 0.01 * std::sqrt(2), 1e-12);
  EXPECT_LT(accuracy->sim3_translation_rmse_m, 1e-13);
}

TEST(PoseAccuracy, RmseIsOverSquares) {
  const std::vector<PoseError> errors{{3, 0.3}, {4, 0.4}};
  EXPECT_NEAR(rmse_of(errors).translation_m, std::sqrt(12.5), 1e-15);
  EXPECT_NEAR(rmse_of(errors).rotation_rad, std::sqrt(0.125), 1e-15);
}

TEST(PoseAccuracy, MarkersOnALineAreAlignedOnTheirCorners) {
  std::vector<Rigid3> truth;
  for (int i = 0; i < 5; ++i) truth.push_back({so3_exp({0.1 * i, 0, 0}), Eigen::Vector3d(i, 0, 0)});
  std::vector<Rigid3> estimate = truth;
  estimate[2].rotation = so3_exp({0, 0, 0.01}) * estimate[2].rotation;
  const auto accuracy = accuracy_of_markers(as_markers(seen_from_elsewhere(truth, estimate)));
  ASSERT_TRUE(accuracy);
  EXPECT_TRUE(accuracy->positions_on_a_line);
  // The turned marker hardly turns the whole line of 4 m: its corners weigh 5e-4 of the rest.
  EXPECT_LT(accuracy->rmse.translation_m, 1e-4);
  EXPECT_NEAR(accuracy->each[2].rotation_rad, 0.01, 1e-4);
  EXPECT_NEAR(accuracy->each[0].rotation_rad, 0, 1e-4);
}

TEST(PoseAccuracy, OneMarkerIsAlignedOnItsCorners) {
  const auto accuracy =
      accuracy_of_markers(as_markers(seen_from_elsewhere({square()[2]}, {square()[2]})));
  ASSERT_TRUE(accuracy);
  EXPECT_TRUE(accuracy->positions_on_a_line);
  EXPECT_LT(accuracy->rmse.translation_m, 1e-13);
  EXPECT_LT(accuracy->rmse.rotation_rad, 1e-13);
}

TEST(PoseAccuracy, CamerasOnALineAreAlignedOnTheirPoses) {
  std::vector<Rigid3> truth;
  for (int i = 0; i < 5; ++i) truth.push_back({so3_exp({0, 0, 0.3 * i}), Eigen::Vector3d(i, 2, 3)});
  const auto accuracy = accuracy_of_cameras(seen_from_elsewhere(truth, truth));
  ASSERT_TRUE(accuracy);
  EXPECT_TRUE(accuracy->positions_on_a_line);
  EXPECT_LT(accuracy->rmse.translation_m, 1e-13);
  EXPECT_LT(accuracy->rmse.rotation_rad, 1e-13);
}

TEST(PoseAccuracy, NothingGivesNothing) {
  EXPECT_FALSE(accuracy_of_markers({}));
  EXPECT_FALSE(accuracy_of_cameras({}));
}

}  // namespace
}  // namespace waymark
