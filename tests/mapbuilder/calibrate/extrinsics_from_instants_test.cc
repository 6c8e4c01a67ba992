#include "mapbuilder/calibrate/extrinsics_from_instants.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/diagnosis/simulated_tracks.h"

namespace waymark {
namespace {

double distance_m(const Rigid3& a, const Rigid3& b) {
  return (a.translation - b.translation).norm();
}

TEST(ExtrinsicsFromInstants, FindAllCamerasThroughMissingAndGrossPlaces) {
  for (const std::size_t cameras : {2U, 3U, 5U, 8U}) {
    const Extrinsics truth = tests::ring_of_cameras(cameras, 45);
    const auto places = extrinsics_from_instants(tests::drive_tracks({}, truth));
    ASSERT_EQ(places.size(), cameras);
    for (std::size_t k = 0; k < cameras; ++k) {
      ASSERT_TRUE(places[k]) << k;
      EXPECT_LT(distance_m(*places[k], truth[k]), 0.003) << k;
      EXPECT_LT(angle_between_rad(places[k]->rotation, truth[k].rotation), 0.003) << k;
    }
  }
}

TEST(ExtrinsicsFromInstants, LinkCamerasThatNeverShareAnInstantWithTheFirst) {
  const Extrinsics truth = tests::ring_of_cameras(3, 60);
  auto tracks = tests::drive_tracks({}, truth);
  for (auto& instant : tracks.instants) {
    if (instant.places[2]) instant.places[0].reset();
  }
  // cam1 and cam0 meet where cam2 is missing.
  tests::SimulatedDrive later;
  later.seed = 7;
  auto more = tests::drive_tracks(later, truth);
  for (auto& instant : more.instants) {
    instant.places[2].reset();
    tracks.instants.push_back(instant);
  }
  const auto places = extrinsics_from_instants(tracks);
  ASSERT_TRUE(places[2]);
  EXPECT_LT(distance_m(*places[2], truth[2]), 0.005);
}

TEST(ExtrinsicsFromInstants, SayNothingOfACameraThatIsNeverThere) {
  const Extrinsics truth = tests::ring_of_cameras(3, 60);
  auto tracks = tests::drive_tracks({}, truth);
  for (auto& instant : tracks.instants) instant.places[1].reset();
  const auto places = extrinsics_from_instants(tracks);
  EXPECT_FALSE(places[1]);
  EXPECT_TRUE(places[2]);
  tracks.instants.clear();
  EXPECT_FALSE(extrinsics_from_instants(tracks)[2]);
  EXPECT_TRUE(extrinsics_from_instants({}).empty());
}

}  // namespace
}  // namespace waymark
