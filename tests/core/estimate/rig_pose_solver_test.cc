#include "core/estimate/rig_pose_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/geometry/symmetric_factor.h"
#include "tests/support/expect_ranges.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

/// Observations of one frame set of a synthetic room, with fixed true markers.
struct FrameSetInRoom {
  Rigid3 truth;
  std::vector<MarkerObservation> observations;
  std::vector<FixedMarkerObservation> fixed;
};

FrameSetInRoom frame_set_in(const test::SyntheticRoom& room, int index, double sigma_px) {
  FrameSetInRoom result;
  result.truth = room.world_from_rig[static_cast<std::size_t>(index)];
  std::vector<int> markers;
  for (const ImageDetections& image : room.images) {
    if (image.stamp != test::room_stamp(index)) continue;
    for (const Detection& d : image.detections) {
      MarkerObservation o;
      o.camera = image.camera;
      o.size_m = 0.3;
      o.corners_px = d.corners;
      o.whitening.fill(Eigen::Matrix2d::Identity() / sigma_px);
      o.ippe = solve_ippe(room.rig.cameras[static_cast<std::size_t>(image.camera)].model, d.corners,
                          0.3);
      result.observations.push_back(o);
      markers.push_back(d.marker.number);
    }
  }
  for (std::size_t i = 0; i < result.observations.size(); ++i) {
    result.fixed.push_back(
        {&result.observations[i], room.world_from_marker[static_cast<std::size_t>(markers[i])]});
  }
  return result;
}

TEST(RigPoseSolver, FindsTheTruthOfExactCorners) {
  const auto room = test::make_room({});
  RigPoseSolver solver(room.rig, {});
  for (int i = 0; i < 60; i += 7) {
    const auto set = frame_set_in(room, i, 1.0);
    const auto estimate = solver.solve(set.fixed);
    ASSERT_TRUE(estimate);
    EXPECT_LT(estimate->best.pose.minus(set.truth).norm(), 1e-6);
    EXPECT_FALSE(estimate->ambiguous);
  }
}

TEST(RigPoseSolver, CovarianceIsConsistentWithTheErrors) {
  // NEES: eᵀ C⁻¹ e is χ² with 6 degrees of freedom; the mean over n sets has deviation √(12/n).
  test::RoomOptions options;
  options.noise_px = 0.2;
  options.frame_sets = 200;
  const auto room = test::make_room(options);
  RigPoseSolver solver(room.rig, {});
  double sum = 0;
  for (int i = 0; i < options.frame_sets; ++i) {
    const auto set = frame_set_in(room, i, options.noise_px);
    const auto estimate = solver.solve(set.fixed);
    ASSERT_TRUE(estimate);
    const Vector6d e = estimate->best.pose.minus(set.truth);
    ASSERT_TRUE(estimate->best.covariance);
    sum += e.dot(SymmetricFactor<6>(*estimate->best.covariance).solve(e));
  }
  const double mean = sum / options.frame_sets;
  EXPECT_NEAR(mean, 6.0, 2.576 * std::sqrt(12.0 / options.frame_sets));
}

TEST(RigPoseSolver, AFlippedMarkerCannotWin) {
  // The first marker seems to fit best, with its flip.
  const auto room = test::make_room({});
  auto set = frame_set_in(room, 5, 1.0);
  ASSERT_GE(set.observations.size(), 3U);
  auto& ippe = *set.observations[0].ippe;
  std::swap(ippe.cam_from_marker[0], ippe.cam_from_marker[1]);
  ippe.rms_px = {0.0, 0.0};
  RigPoseSolver solver(room.rig, {});
  const auto estimate = solver.solve(set.fixed);
  ASSERT_TRUE(estimate);
  EXPECT_LT(estimate->best.pose.minus(set.truth).norm(), 1e-6);
}

TEST(RigPoseSolver, ThePapersSeedTrustsTheMarkerThatFitsItselfBest) {
  const auto room = test::make_room({});
  auto set = frame_set_in(room, 5, 1.0);
  ASSERT_GE(set.observations.size(), 3U);
  RigPoseOptions paper;
  paper.seed = RigPoseSeed::best_own_fit;
  RigPoseSolver by_paper(room.rig, paper);
  auto estimate = by_paper.solve(set.fixed);
  ASSERT_TRUE(estimate);
  EXPECT_LT(estimate->best.pose.minus(set.truth).norm(), 1e-6);
  EXPECT_FALSE(estimate->runner_up);

  // It is believed even when it says that the rig looks away from all markers.
  for (Rigid3& cam_from_marker : set.observations[0].ippe->cam_from_marker) {
    cam_from_marker.rotation = cam_from_marker.rotation * so3_exp({0, 3.0, 0});
  }
  set.observations[0].ippe->rms_px = {0.0, 0.0};
  estimate = by_paper.solve(set.fixed);
  EXPECT_TRUE(!estimate || estimate->best.pose.minus(set.truth).norm() > 0.05);
  RigPoseSolver ours(room.rig, {});
  EXPECT_LT(ours.solve(set.fixed)->best.pose.minus(set.truth).norm(), 1e-6);
}

TEST(RigPoseSolver, AMovedMarkerIsOutvoted) {
  test::RoomOptions options;
  options.noise_px = 0.1;
  const auto room = test::make_room(options);
  auto set = frame_set_in(room, 9, options.noise_px);
  ASSERT_GE(set.fixed.size(), 4U);
  set.fixed[1].world_from_marker.translation += Eigen::Vector3d(0.1, 0.2, 0.1);
  RigPoseOptions robust;
  robust.loss.loss = Loss::tukey;
  RigPoseSolver solver(room.rig, robust);
  const auto estimate = solver.solve(set.fixed);
  ASSERT_TRUE(estimate);
  EXPECT_LT((estimate->best.pose.translation - set.truth.translation).norm(), 0.01);
}

TEST(RigPoseSolver, OneFarFrontalMarkerIsAmbiguousOneNearTiltedMarkerIsNot) {
  const Rig rig = test::ring_rig(1);
  const CameraModel& camera = rig.cameras[0].model;
  const auto solve = [&](double distance_m, double tilt_rad) {
    const Rigid3 cam_from_marker{so3_exp({M_PI, 0, 0}) * so3_exp({tilt_rad, 0, 0}),
                                 {0, 0, distance_m}};
    MarkerObservation o;
    o.size_m = 0.3;
    const auto x = marker_corners(o.size_m);
    for (std::size_t i = 0; i < 4; ++i) o.corners_px[i] = *camera.project(cam_from_marker * x[i]);
    o.whitening.fill(Eigen::Matrix2d::Identity() / 0.3);
    o.ippe = solve_ippe(camera, o.corners_px, o.size_m);
    const FixedMarkerObservation fixed{&o, Rigid3{}};
    RigPoseSolver solver(rig, {});
    return solver.solve({&fixed, 1})->ambiguous;
  };
  EXPECT_TRUE(solve(5.0, 0.3));
  EXPECT_FALSE(solve(0.8, 0.8));
}

TEST(RigPoseSolver, AWrongPriorCannotTrapIt) {
  const auto room = test::make_room({});
  const auto set = frame_set_in(room, 20, 1.0);
  RigPoseSolver solver(room.rig, {});
  const Rigid3 wrong{so3_exp({0, 0, 3}) * set.truth.rotation,
                     set.truth.translation + Eigen::Vector3d(1, 1, 0)};
  const auto estimate = solver.solve(set.fixed, {&wrong, 1});
  ASSERT_TRUE(estimate);
  EXPECT_LT(estimate->best.pose.minus(set.truth).norm(), 1e-6);
}

TEST(RigPoseSolver, WithoutObservationsThereIsNoPose) {
  const Rig rig = test::ring_rig(1);
  RigPoseSolver solver(rig, {});
  EXPECT_FALSE(solver.solve({}));
  const Rigid3 prior;
  EXPECT_FALSE(solver.solve({}, {&prior, 1}));
}

TEST(RigPoseOptions, AreHeldToTheirRanges) {
  using Options = RigPoseOptions;
  expect_ranges<Options>(
      {ranged("score_scale_sigmas", &Options::score_scale_sigmas, {5, 100}),
       ranged("max_seed_observations", &Options::max_seed_observations, {1, 1000}),
       ranged("max_refined", &Options::max_refined, {2, 50}),
       ranged("max_iterations", &Options::max_iterations, {1, 200}),
       ranged("ambiguity_gap", &Options::ambiguity_gap, {0, 1000}),
       ranged("distinct_rad", &Options::distinct_rad, {0.002, 0.5}),
       ranged("distinct_m", &Options::distinct_m, {0.001, 1}),
       {"bounded_score_sigmas", {5, 100}, [](Options& o, double v) { o.bounded_score_sigmas = v; }},
       {"loss.scale_sigmas", ObservationLoss::kScaleSigmas,
        [](Options& o, double v) { o.loss.scale_sigmas = v; }}});
}

}  // namespace
}  // namespace waymark
