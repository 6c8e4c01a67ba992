#include "mapbuilder/growth/incremental_mapper.h"

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

constexpr ComponentIndex kAll(0);
constexpr double kNoise_px = 0.2;

test::SyntheticRoom noisy_room() {
  test::RoomOptions options;
  options.noise_px = kNoise_px;
  return test::make_room(options);
}

class Mapper : public testing::Test {
 protected:
  /// Where a marker stands in the world that the seed's rig makes.
  [[nodiscard]] Rigid3 true_pose(MarkerIndex m) const {
    return known.truth.world_from_rig[mapper.seed_of(kAll)]->best.pose.inverse() *
           *known.truth.world_from_marker[m];
  }

  test::SyntheticRoom room = noisy_room();
  test::PreparedRoom known{room};
  IncrementalMapper mapper{known.selection, MapperOptions{}};
  Estimate nothing{known.selection, NoiseModel{}};
  Progress silent{false};
};

TEST_F(Mapper, TheSeedsRigIsTheWorld) {
  const Estimate seeded = mapper.seed(kAll, nothing);
  const auto& rig = seeded.world_from_rig[mapper.seed_of(kAll)];
  ASSERT_TRUE(rig);
  EXPECT_EQ(rig->best.pose.translation.norm(), 0.0);
  EXPECT_FALSE(nothing.world_from_rig[mapper.seed_of(kAll)]) << "a step changes what it returns";
}

TEST_F(Mapper, GrowsUntilEverythingIsPlacedAndConverges) {
  Estimate grown = mapper.grow(kAll, nothing, silent);
  const ConvergedEstimate converged = mapper.converge({{kAll}, {}}, grown, silent);
  EXPECT_TRUE(converged.estimate.components[kAll].converged);
  EXPECT_FALSE(grown.components[kAll].converged);
  EXPECT_NEAR(converged.estimate.components[kAll].noise.model_sigma_px, kNoise_px, 0.1 * kNoise_px);
  for (const MarkerIndex m : known.observations.markers.indices()) {
    const auto& pose = converged.estimate.world_from_marker[m];
    ASSERT_TRUE(pose);
    EXPECT_LT(pose->minus(true_pose(m)).head<3>().norm(), 0.02);
  }
  for (const auto& rig : converged.estimate.world_from_rig) EXPECT_TRUE(rig);
}

TEST(MapperThatGivesUp, StopsAtARigThatContradictsItsImagesAndAtNoOther) {
  MapperOptions options;
  options.growth.give_up_sigma_px = 3;
  Progress silent(false);
  for (const bool exchanged : {false, true}) {
    test::SyntheticRoom room = noisy_room();
    if (exchanged) {
      std::swap(room.rig.cameras[0].rig_from_cam, room.rig.cameras[1].rig_from_cam);
    }
    const test::PreparedRoom known(room);
    const IncrementalMapper mapper(known.selection, options);
    const Estimate grown = mapper.grow(kAll, {known.selection, NoiseModel{}}, silent);
    EXPECT_EQ(mapper.gives_up(kAll, grown), exchanged);
    const auto placed =
        std::count_if(grown.world_from_marker.begin(), grown.world_from_marker.end(),
                      [](const auto& pose) { return pose.has_value(); });
    EXPECT_EQ(placed == static_cast<std::ptrdiff_t>(grown.world_from_marker.size()), !exchanged);
  }
}

TEST_F(Mapper, ReconsideringMovesAFlippedMarkerBackAndNoOther) {
  Estimate flipped = known.truth;
  const MarkerIndex m(7);
  Vector6d off;
  off << 0.3, 0, 0, 0, 0, 0.5;
  flipped.world_from_marker[m] = flipped.world_from_marker[m]->plus(off);
  const ReconsideredEstimate right = mapper.reconsider(kAll, flipped);
  EXPECT_GE(right.moved, 1U);
  EXPECT_LT(right.estimate.world_from_marker[m]
                ->minus(*known.truth.world_from_marker[m])
                .head<3>()
                .norm(),
            0.03);
  EXPECT_EQ(mapper.reconsider(kAll, known.truth).moved, 0U);
}

TEST_F(Mapper, ObservationsArePreparedByWhateverEstimateIsAsked) {
  Estimate other = known.truth;
  other.components[kAll].noise.model_sigma_px = 0.5;
  const auto whitening = [&](const Estimate& estimate) {
    return mapper.prepared(estimate)[ObservationIndex(0)].whitening[0](0, 0);
  };
  EXPECT_NEAR(whitening(known.truth), 1.0, 1e-12);
  EXPECT_NEAR(whitening(other), 2.0, 1e-12);
  EXPECT_NEAR(whitening(known.truth), 1.0, 1e-12);
}

TEST_F(Mapper, CeresLeadsToTheSameMap) {
  MapperOptions options;
  options.solver = BundleSolver::ceres;
  const IncrementalMapper other(known.selection, options);
  const auto map_by = [&](const IncrementalMapper& by) {
    return by.converge({{kAll}, {}}, by.grow(kAll, nothing, silent), silent).estimate;
  };
  const Estimate own = map_by(mapper);
  const Estimate ceres = map_by(other);
  for (const MarkerIndex m : known.observations.markers.indices()) {
    ASSERT_TRUE(own.world_from_marker[m] && ceres.world_from_marker[m]);
    EXPECT_LT(own.world_from_marker[m]->minus(*ceres.world_from_marker[m]).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace waymark
