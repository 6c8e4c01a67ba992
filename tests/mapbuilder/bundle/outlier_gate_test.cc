#include "mapbuilder/bundle/outlier_gate.h"

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

constexpr ObservationIndex kFirst(0);

/// A room whose first observation has one corner so far off.
test::PreparedRoom shifted_by(const test::SyntheticRoom& room, double px) {
  return test::PreparedRoom(room, [&](Observations& o) { o.all[kFirst].corners_px[1].x() += px; });
}

TEST(OutlierGate, RejectsBeyondTheThresholdAndReadmitsBelowNineTenths) {
  const auto room = test::make_room({});
  const OutlierGateOptions options;
  Estimate estimate = test::PreparedRoom(room).truth;
  const auto gated = [&](double sigmas) {
    const test::PreparedRoom shifted = shifted_by(room, sigmas * options.reject_sigmas);
    GatedEstimate result = gate_outliers(shifted.prepared, shifted.all(), options, estimate);
    estimate = std::move(result.estimate);
    return result.changed;
  };
  EXPECT_EQ(gated(0.99), 0U);
  EXPECT_EQ(gated(1.01), 1U);
  EXPECT_FALSE(estimate.accepts(kFirst));
  EXPECT_EQ(gated(0.95), 0U);
  EXPECT_EQ(gated(0.85), 1U);
  EXPECT_TRUE(estimate.accepts(kFirst));
}

TEST(OutlierGate, SwitchedOffItChangesNothing) {
  const auto room = test::make_room({});
  const test::PreparedRoom shifted = shifted_by(room, 1000);
  const GatedEstimate result =
      gate_outliers(shifted.prepared, shifted.all(), {false, 20}, shifted.truth);
  EXPECT_EQ(result.changed, 0U);
  EXPECT_TRUE(result.estimate.accepts(kFirst));
}

}  // namespace
}  // namespace waymark
