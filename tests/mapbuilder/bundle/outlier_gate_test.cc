#include "mapbuilder/bundle/outlier_gate.h"

#include "tests/mapbuilder/observations/room_table.h"

namespace waymark {
namespace {

TEST(OutlierGate, RejectsBeyondTheThresholdAndReadmitsBelowNineTenths) {
  const auto room = test::make_room({});
  auto table = test::table_of(room);  // whitened by 1 px
  MapState state = test::true_state(room, table);
  const auto all = test::all_observations(table);
  const GateOptions options;
  const auto shift_first = [&](double px) {
    table.observations[0].corners_px = test::table_of(room).observations[0].corners_px;
    table.observations[0].corners_px[1].x() += px;
  };
  shift_first(0.99 * options.reject_sigmas);
  EXPECT_EQ(update_gate(table, all, options, state), 0U);
  shift_first(1.01 * options.reject_sigmas);
  EXPECT_EQ(update_gate(table, all, options, state), 1U);
  EXPECT_EQ(state.accepted[0], 0);
  shift_first(0.95 * options.reject_sigmas);
  EXPECT_EQ(update_gate(table, all, options, state), 0U);
  shift_first(0.85 * options.reject_sigmas);
  EXPECT_EQ(update_gate(table, all, options, state), 1U);
  EXPECT_EQ(state.accepted[0], 1);
}

TEST(OutlierGate, SwitchedOffItChangesNothing) {
  const auto room = test::make_room({});
  auto table = test::table_of(room);
  MapState state = test::true_state(room, table);
  table.observations[0].corners_px[0].x() += 1000;
  EXPECT_EQ(update_gate(table, test::all_observations(table), {false, 20}, state), 0U);
  EXPECT_EQ(state.accepted[0], 1);
}

}  // namespace
}  // namespace waymark
