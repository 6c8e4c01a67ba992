#include "mapbuilder/bundle/noise_model.h"

#include "tests/mapbuilder/observations/room_table.h"

namespace waymark {
namespace {

TEST(NoiseModel, FindsTheNoiseThatIsThere) {
  for (const double sigma_px : {0.05, 0.3, 2.0}) {
    test::RoomOptions options;
    options.noise_px = sigma_px;
    const auto room = test::make_room(options);
    const auto table = test::table_of(room);
    const double estimate = estimate_model_sigma_px(table, test::true_state(room, table),
                                                    test::all_observations(table), {}, 0.0);
    EXPECT_NEAR(estimate, sigma_px, 0.05 * sigma_px);
  }
}

TEST(NoiseModel, TheDetectorsOwnCovarianceLeavesNothingToTheModel) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  options.state_covariances = true;
  const auto room = test::make_room(options);
  const auto table = test::table_of(room);
  const double estimate = estimate_model_sigma_px(table, test::true_state(room, table),
                                                  test::all_observations(table), {}, 0.0);
  EXPECT_LT(estimate, 0.08);
}

TEST(NoiseModel, ATwentiethOfOutliersHardlyMattersAndBoundsHold) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  auto table = test::table_of(room);
  for (std::size_t i = 0; i < table.observations.size(); i += 20) {
    for (auto& corner : table.observations[i].corners_px) corner.x() += 300;
  }
  const MapState state = test::true_state(room, table);
  const double estimate =
      estimate_model_sigma_px(table, state, test::all_observations(table), {}, 0.0);
  EXPECT_GT(estimate, 0.28);
  EXPECT_LT(estimate, 0.45);
  EXPECT_EQ(estimate_model_sigma_px(table, state, {}, {}, 0.0), NoiseModel{}.model_sigma_px);
}

TEST(NoiseModel, WeighsByCovarianceByThePaperOrNotAtAll) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  options.state_covariances = true;
  const auto room = test::make_room(options);
  auto table = test::table_of(room);
  NoiseModel noise;
  noise.model_sigma_px = 0.4;
  set_whitening(table, noise);
  EXPECT_NEAR(table.observations[0].whitening[0](0, 0), 1 / 0.5, 1e-9);
  noise.weighting = Weighting::none;
  set_whitening(table, noise);
  EXPECT_NEAR(table.observations[0].whitening[0](0, 0), 1 / 0.4, 1e-9);
  noise.weighting = Weighting::paper;
  set_whitening(table, noise);
  const double weight = observation_weight(*table.observations[0].ippe, noise.paper);
  EXPECT_NEAR(table.observations[0].whitening[0](0, 0), std::sqrt(weight) / 0.4, 1e-9);
}

}  // namespace
}  // namespace waymark
