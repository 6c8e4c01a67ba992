#include "mapbuilder/bundle/noise_model.h"

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

TEST(NoiseModel, FindsTheNoiseThatIsThere) {
  for (const double sigma_px : {0.05, 0.3, 2.0}) {
    test::RoomOptions options;
    options.noise_px = sigma_px;
    const auto room = test::make_room(options);
    const test::PreparedRoom known(room);
    const double estimate =
        estimate_model_sigma_px(known.prepared, known.truth, known.all(), {}, 0.0);
    EXPECT_NEAR(estimate, sigma_px, 0.05 * sigma_px);
  }
}

TEST(NoiseModel, TheDetectorsOwnCovarianceLeavesNothingToTheModel) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  options.state_covariances = true;
  const auto room = test::make_room(options);
  const test::PreparedRoom known(room);
  const double estimate =
      estimate_model_sigma_px(known.prepared, known.truth, known.all(), {}, 0.0);
  EXPECT_LT(estimate, 0.08);
}

TEST(NoiseModel, ATwentiethOfOutliersHardlyMattersAndBoundsHold) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  const auto room = test::make_room(options);
  const test::PreparedRoom known(room, [](Observations& observations) {
    for (std::size_t i = 0; i < observations.usable; i += 20) {
      for (auto& corner : observations.all[ObservationIndex(i)].corners_px) corner.x() += 300;
    }
  });
  const double estimate =
      estimate_model_sigma_px(known.prepared, known.truth, known.all(), {}, 0.0);
  EXPECT_GT(estimate, 0.28);
  EXPECT_LT(estimate, 0.45);
  EXPECT_EQ(estimate_model_sigma_px(known.prepared, known.truth, {}, {}, 0.0),
            NoiseModel{}.model_sigma_px);
}

TEST(NoiseModel, WeighsByCovarianceByThePaperOrNotAtAll) {
  test::RoomOptions options;
  options.noise_px = 0.3;
  options.state_covariances = true;
  const auto room = test::make_room(options);
  const test::PreparedRoom known(room);
  const ObservationIndex first(0);
  const auto& ippe = known.prepared[first].ippe;
  const auto whitened = [&](const NoiseModel& noise) {
    return whitening_of(known.observations[first], ippe, noise)[0](0, 0);
  };
  NoiseModel noise;
  noise.model_sigma_px = 0.4;
  EXPECT_NEAR(whitened(noise), 1 / 0.5, 1e-9);
  noise.weighting = Weighting::none;
  EXPECT_NEAR(whitened(noise), 1 / 0.4, 1e-9);
  noise.weighting = Weighting::paper;
  EXPECT_NEAR(whitened(noise), std::sqrt(observation_weight(*ippe, noise.paper)) / 0.4, 1e-9);
}

}  // namespace
}  // namespace waymark
