#include "mapbuilder/mapping/joint_adjustment.h"

#include <random>

#include "tests/mapbuilder/mapping/room_table.h"

namespace waymark {
namespace {

TEST(JointAdjustment, BringsDisturbedPosesBackToTheTruth) {
  const auto room = test::make_room({});
  const auto table = test::table_of(room);
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
  const auto summary = adjust_jointly(table, test::all_observations(table), 0,
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
  const auto summary = adjust_jointly(table, test::all_observations(table), 0,
                                      {{Loss::squared, 6.0}, 50, 1e-10, 1e-6}, state);
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.observations, table.observations.size() - 1);
  EXPECT_EQ(state.rigs[0]->best.pose.minus(anchor).norm(), 0.0);
  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    EXPECT_LT(state.world_from_marker[m]->minus(room.world_from_marker[m]).head<3>().norm(), 0.02);
  }
}

TEST(JointAdjustment, TheSameTwiceIsTheSameToTheLastBit) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  const auto table = test::table_of(room);
  const auto adjusted = [&] {
    MapState state = test::true_state(room, table);
    adjust_jointly(table, test::all_observations(table), 0, {{Loss::huber, 6.0}, 50, 1e-10, 1e-6},
                   state);
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
