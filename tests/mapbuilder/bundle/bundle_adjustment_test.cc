#include "mapbuilder/bundle/bundle_adjustment.h"

#include <limits>
#include <random>

#include "tests/mapbuilder/bundle/bundle_of_room.h"
#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

constexpr BundleOptions kToTheEnd{.max_iterations = 50, .function_tolerance = 1e-14};

double off_truth(const test::SyntheticRoom& room, const Estimate& estimate, MarkerIndex m) {
  return estimate.world_from_marker[m]->minus(room.world_from_marker[m.value()]).norm();
}

TEST(BundleAdjustment, BringsDisturbedPosesBackToTheTruth) {
  const auto room = test::make_room({});
  const test::PreparedRoom prepared(room);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 0.02);
  const auto disturb = [&](const Rigid3& pose) {
    return pose.plus(Vector6d::NullaryExpr([&] { return normal(random); }));
  };
  Estimate start = prepared.truth;
  for (auto& marker : start.world_from_marker) marker = disturb(*marker);
  for (auto& rig : start.world_from_rig) rig->best.pose = disturb(rig->best.pose);
  start.world_from_rig.front() = prepared.truth.world_from_rig.front();
  const BundleSolution solution = adjust(test::bundle_of(prepared), kToTheEnd, start);
  EXPECT_EQ(solution.summary.termination, BundleTermination::converged);
  EXPECT_LT(solution.summary.final_cost, 1e-10);
  for (const MarkerIndex m : prepared.observations.markers.indices()) {
    EXPECT_LT(off_truth(room, solution.estimate, m), 1e-6);
  }
}

TEST(BundleAdjustment, TheSeedStaysAndRejectedObservationsDoNotCount) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  // One gross outlier, rejected: the result must not know of it.
  const ObservationIndex outlier(40);
  const test::PreparedRoom prepared(room, [&](Observations& observations) {
    observations.all[outlier].corners_px[0] += Eigen::Vector2d(500, 0);
  });
  Estimate start = prepared.truth;
  start.accepted[outlier] = 0;
  const BundleSolution solution = adjust(test::bundle_of(prepared), kToTheEnd, start);
  EXPECT_EQ(solution.summary.termination, BundleTermination::converged);
  EXPECT_EQ(solution.summary.observations, prepared.observations.usable - 1);
  EXPECT_EQ(solution.estimate.world_from_rig.front()
                ->best.pose.minus(start.world_from_rig.front()->best.pose)
                .norm(),
            0.0);
  for (const MarkerIndex m : prepared.observations.markers.indices()) {
    EXPECT_LT(off_truth(room, solution.estimate, m), 0.02);
  }
}

TEST(BundleAdjustment, ConstantMarkersStayAndTheRestFindsItsPlaceAmongThem) {
  const auto room = test::make_room({});
  const test::PreparedRoom prepared(room);
  BundleProblem problem = test::bundle_of(prepared);
  problem.constant = {{}, {prepared.observations.markers.size(), 1}};
  Vector6d off;
  off << 0.02, -0.03, 0.01, 0.02, 0.01, -0.02;
  Estimate start = prepared.truth;
  for (const MarkerIndex m : {MarkerIndex(2), MarkerIndex(5)}) {
    problem.constant.markers[m] = 0;
    start.world_from_marker[m] = start.world_from_marker[m]->plus(off);
    off = -off;
  }
  const BundleSolution solution = adjust(problem, kToTheEnd, start);
  EXPECT_EQ(solution.summary.termination, BundleTermination::converged);
  for (const MarkerIndex m : prepared.observations.markers.indices()) {
    if (problem.constant.holds(m)) {
      EXPECT_EQ(off_truth(room, solution.estimate, m), 0.0);
    } else {
      EXPECT_LT(off_truth(room, solution.estimate, m), 1e-6);
    }
  }
}

TEST(BundleAdjustment, AComponentThatNothingFixesLeavesTheCalibrationDetermined) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  auto room = test::make_room(options);
  // The second half of the walk sees other numbers on the walls: two components.
  const auto walls = room.world_from_marker;
  room.world_from_marker.resize(100);
  room.world_from_marker.insert(room.world_from_marker.end(), walls.begin(), walls.end());
  for (ImageDetections& image : room.images) {
    if (image.stamp < test::room_stamp(30)) continue;
    for (Detection& d : image.detections) d.marker.number += 100;
  }
  const test::PreparedRoom prepared(room);
  BundleProblem problem = test::bundle_of(prepared);
  problem.scope.variable.extrinsics = true;
  const BundleSolution solution = adjust(problem, kToTheEnd, prepared.truth);
  EXPECT_EQ(solution.summary.termination, BundleTermination::converged);
  ASSERT_TRUE(solution.uncertainty);
  for (const CameraIndex camera : {CameraIndex(1), CameraIndex(2)}) {
    EXPECT_GT(solution.uncertainty->cameras[camera].position_m, 1e-5);
    EXPECT_LT(solution.uncertainty->cameras[camera].position_m, 0.002);
  }
}

TEST(BundleAdjustment, TheSameTwiceIsTheSameToTheLastBit) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  const test::PreparedRoom prepared(room);
  BundleProblem problem = test::bundle_of(prepared);
  problem.loss = {Loss::huber, 6.0};
  const Estimate a = adjust(problem, kToTheEnd, prepared.truth).estimate;
  const Estimate b = adjust(problem, kToTheEnd, prepared.truth).estimate;
  for (const MarkerIndex m : prepared.observations.markers.indices()) {
    EXPECT_EQ(a.world_from_marker[m]->translation, b.world_from_marker[m]->translation);
    EXPECT_EQ(a.world_from_marker[m]->rotation.coeffs(), b.world_from_marker[m]->rotation.coeffs());
  }
}

TEST(BundleAdjustment, SaysHowItEnded) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  const test::PreparedRoom prepared(room);
  BundleProblem problem = test::bundle_of(prepared);
  BundleOptions one_step = kToTheEnd;
  one_step.max_iterations = 1;
  const BundleSummary cut_short = adjust(problem, one_step, prepared.truth).summary;
  EXPECT_EQ(cut_short.termination, BundleTermination::no_convergence);
  EXPECT_EQ(cut_short.iterations, 1);
  EXPECT_LT(cut_short.final_cost, cut_short.initial_cost);
  problem.observations.clear();
  EXPECT_EQ(adjust(problem, kToTheEnd, prepared.truth).summary.termination,
            BundleTermination::nothing_to_do);
}

TEST(BundleOptions, AreHeldToTheirRanges) {
  using Options = BundleOptions;
  expect_ranges<Options>({ranged("max_iterations", &Options::max_iterations, {1, 1000}),
                          ranged("function_tolerance", &Options::function_tolerance, {1e-16, 0.1}),
                          ranged("initial_damping", &Options::initial_damping, {1e-16, 1}),
                          ranged("threads", &Options::threads, {1, 1024})});
  expect_ranges<BundleScope>(
      {ranged("size_sigma", &BundleScope::size_sigma, {1e-4, 0.1}),
       ranged("edge_bias_sigma_px", &BundleScope::edge_bias_sigma_px, {0.01, 2})});
}

}  // namespace
}  // namespace waymark
