#include "mapbuilder/bundle/joint_adjustment.h"

#include <random>

#include "tests/mapbuilder/observations/room_table.h"

namespace waymark {
namespace {

TEST(JointAdjustment, BringsDisturbedPosesBackToTheTruth) {
  const auto room = test::make_room({});
  auto table = test::table_of(room);
  MapState state = test::true_state(room, table);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 0.02);
  const auto disturb = [&](const Rigid3& pose) {
    return pose.plus(Vector6d::NullaryExpr([&] { return normal(random); }));
  };
  for (auto& marker : state.world_from_marker) marker = disturb(*marker);
  for (std::size_t f = 1; f < state.rigs.size(); ++f) {
    state.rigs[f]->best.pose = disturb(state.rigs[f]->best.pose);
  }
  const auto summary = adjust_jointly(table, test::all_observations(table), {{0}, {}},
                                      {{Loss::squared, 6.0}, 50, 1e-14, 1e-6}, state);
  EXPECT_TRUE(summary.converged);
  EXPECT_LT(summary.final_cost, 1e-10);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    EXPECT_LT(state.world_from_marker[m]->minus(room.world_from_marker[m]).norm(), 1e-6);
  }
}

TEST(JointAdjustment, TheAnchorStaysAndRejectedObservationsDoNotCount) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  auto table = test::table_of(room);
  MapState state = test::true_state(room, table);
  // One gross outlier, rejected: the result must not know of it.
  table.observations[40].corners_px[0] += Eigen::Vector2d(500, 0);
  state.accepted[40] = 0;
  const Rigid3 anchor = state.rigs[0]->best.pose;
  const auto summary = adjust_jointly(table, test::all_observations(table), {{0}, {}},
                                      {{Loss::squared, 6.0}, 50, 1e-10, 1e-6}, state);
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.observations, table.observations.size() - 1);
  EXPECT_EQ(state.rigs[0]->best.pose.minus(anchor).norm(), 0.0);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    EXPECT_LT(state.world_from_marker[m]->minus(room.world_from_marker[m]).head<3>().norm(), 0.02);
  }
}

TEST(JointAdjustment, HeldMarkersStayAndTheRestFindsItsPlaceAmongThem) {
  const auto room = test::make_room({});
  auto table = test::table_of(room);
  MapState state = test::true_state(room, table);
  HeldPoses held{{}, std::vector<char>(table.markers.size(), 1)};
  held.markers[2] = held.markers[5] = 0;
  Vector6d off;
  off << 0.02, -0.03, 0.01, 0.02, 0.01, -0.02;
  state.world_from_marker[2] = state.world_from_marker[2]->plus(off);
  state.world_from_marker[5] = state.world_from_marker[5]->plus(-off);
  const auto summary = adjust_jointly(table, test::all_observations(table), held,
                                      {{Loss::squared, 6.0}, 50, 1e-14, 1e-6}, state);
  EXPECT_TRUE(summary.converged);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    const double off_truth = state.world_from_marker[m]->minus(room.world_from_marker[m]).norm();
    if (held.markers[m] != 0) {
      EXPECT_EQ(off_truth, 0.0);
    } else {
      EXPECT_LT(off_truth, 1e-6);
    }
  }
}

TEST(JointAdjustment, APieceThatNothingTiesLeavesTheCalibrationDetermined) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  auto room = test::make_room(options);
  // The second half of the walk sees other numbers on the walls: two pieces.
  for (ImageDetections& image : room.images) {
    if (image.stamp < test::room_stamp(30)) continue;
    for (Detection& d : image.detections) d.marker.number += 100;
  }
  auto table = test::table_of(room);
  MapState state(table);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    state.world_from_marker[m] =
        room.world_from_marker[static_cast<std::size_t>(table.markers[m].number % 100)];
  }
  for (std::size_t f = 0; f < table.frame_sets.size(); ++f) {
    state.rigs[f] = RigPoseEstimate{};
    state.rigs[f]->best.pose = room.world_from_rig[f];
  }
  AdjustmentOptions adjustment{{Loss::squared, 6.0}, 50, 1e-10, 1e-6};
  adjustment.scope.free.extrinsics = true;
  const auto summary =
      adjust_jointly(table, test::all_observations(table), {{0}, {}}, adjustment, state);
  EXPECT_TRUE(summary.converged);
  ASSERT_TRUE(summary.uncertainty);
  for (const std::size_t camera : {1U, 2U}) {
    EXPECT_GT(summary.uncertainty->cameras[camera].position_m, 1e-5);
    EXPECT_LT(summary.uncertainty->cameras[camera].position_m, 0.002);
  }
}

TEST(JointAdjustment, TheSameTwiceIsTheSameToTheLastBit) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  auto table = test::table_of(room);
  const auto adjusted = [&] {
    MapState state = test::true_state(room, table);
    adjust_jointly(table, test::all_observations(table), {{0}, {}},
                   {{Loss::huber, 6.0}, 50, 1e-10, 1e-6}, state);
    return state;
  };
  const MapState a = adjusted();
  const MapState b = adjusted();
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    EXPECT_EQ(a.world_from_marker[m]->translation, b.world_from_marker[m]->translation);
    EXPECT_EQ(a.world_from_marker[m]->rotation.coeffs(), b.world_from_marker[m]->rotation.coeffs());
  }
}

}  // namespace
}  // namespace waymark
