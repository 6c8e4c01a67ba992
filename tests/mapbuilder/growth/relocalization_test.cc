#include "mapbuilder/growth/relocalization.h"

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

MarkerMap true_map(const test::SyntheticRoom& room) {
  MarkerMap map;
  SubMap submap;
  for (std::size_t i = 0; i < room.world_from_marker.size(); ++i) {
    MapMarker marker;
    marker.id = {Family::tag36h11, static_cast<int>(i)};
    marker.stated_size_m = marker.size_m = 0.3;
    marker.world_from_marker = room.world_from_marker[i];
    submap.markers.push_back(marker);
  }
  map.submaps.push_back(submap);
  return map;
}

TEST(Relocalization, EveryFrameSetFindsItsPlaceOnATrueMap) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  const auto room = test::make_room(options);
  const auto observations = test::observations_of(room);
  Progress silent(false);
  const auto results = relocalize(observations, true_map(room), {}, silent);
  ASSERT_EQ(results.size(), 1U);
  ASSERT_EQ(results[0].trajectory.size(), 60U);
  EXPECT_EQ(results[0].localized, results[0].candidates);
  EXPECT_EQ(results[0].rejected, 0U);
  EXPECT_NEAR(results[0].model_sigma_px, 0.2, 0.02);
  for (const LocalizedFrameSet& localized : results[0].trajectory) {
    const auto& truth = room.world_from_rig[localized.frame_set.value()];
    EXPECT_LT(localized.world_from_rig.minus(truth).head<3>().norm(), 0.01);
  }
}

TEST(Relocalization, UsesTheMapsSizesNotTheCatalogs) {
  auto room = test::make_room({});
  MarkerCatalog::FamilyEntry wrong = room.catalog.entries().front();
  wrong.default_size_m = 0.2;
  const MarkerMap map = true_map(room);
  room.catalog = MarkerCatalog({wrong});
  const auto observations = test::observations_of(room);
  Progress silent(false);
  const auto results = relocalize(observations, map, {}, silent);
  EXPECT_LT(results[0].rms_all_px, 1e-3);
}

TEST(Relocalization, AMovedMarkerIsRejected) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  const auto room = test::make_room(options);
  const auto observations = test::observations_of(room);
  MarkerMap map = true_map(room);
  map.submaps[0].markers[11].world_from_marker.translation += Eigen::Vector3d(0.2, 0.2, 0.2);
  Progress silent(false);
  const auto results = relocalize(observations, map, {}, silent);
  EXPECT_EQ(results[0].rejected, Selection(observations).used_of(MarkerIndex(11)).size());
}

}  // namespace
}  // namespace waymark
