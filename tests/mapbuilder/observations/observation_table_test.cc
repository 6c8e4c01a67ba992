#include "mapbuilder/observations/observation_table.h"

#include "tests/mapbuilder/observations/room_table.h"

namespace waymark {
namespace {

TEST(ObservationTable, HoldsEveryDetectionOnce) {
  const auto room = test::make_room({});
  std::size_t detections = 0;
  for (const auto& image : room.images) detections += image.detections.size();
  const auto table = test::table_of(room);
  EXPECT_EQ(table.observations.size(), detections);
  EXPECT_EQ(table.frame_sets.size(), 60U);
  std::size_t by_marker = 0;
  for (const auto& observations : table.observations_of_marker) by_marker += observations.size();
  EXPECT_EQ(by_marker, detections);
}

TEST(ObservationTable, MonoMakesEveryImageAFrame) {
  const auto room = test::make_room({});
  const auto table = test::table_of(room, {true, 1});
  EXPECT_EQ(table.frame_sets.size(), room.images.size());
  EXPECT_EQ(table.rigs.size(), 3U);
  for (const auto& rig : table.rigs) {
    EXPECT_EQ(rig.cameras.front().rig_from_cam.translation.norm(), 0);
  }
}

TEST(ObservationTable, AnIdTwiceInOneImageIsNotUsed) {
  auto room = test::make_room({});
  ImageDetections* image = nullptr;
  for (auto& candidate : room.images) {
    if (candidate.detections.size() >= 3) image = &candidate;
  }
  ASSERT_NE(image, nullptr);
  const std::size_t before = test::table_of(room).observations.size();
  image->detections[1].marker = image->detections[0].marker;
  const auto table = test::table_of(room);
  EXPECT_EQ(table.repeated_in_image, 2);
  EXPECT_EQ(table.observations.size(), before - 2);
}

TEST(ObservationTable, SizesThatDisagreeAndRigsWithoutTransformsAreRefused) {
  const auto room = test::make_room({});
  auto other = test::capture_of(room, "other");
  MarkerCatalog::FamilyEntry family = room.catalog.entries().front();
  family.default_size_m = 0.25;
  other.catalog = MarkerCatalog({family});
  const auto sizes = make_observation_table({test::capture_of(room), other}, {});
  ASSERT_FALSE(sizes);
  EXPECT_EQ(sizes.error().kind, ErrorKind::bad_data);

  auto loose = test::capture_of(room);
  loose.rig.has_extrinsics = false;
  EXPECT_EQ(make_observation_table({loose}, {}).error().kind, ErrorKind::bad_data);
  EXPECT_TRUE(make_observation_table({loose}, {true, 1}));
  EXPECT_EQ(make_observation_table({}, {}).error().kind, ErrorKind::usage);
  EXPECT_EQ(
      make_observation_table({test::capture_of(room), test::capture_of(room)}, {}).error().kind,
      ErrorKind::usage);
}

}  // namespace
}  // namespace waymark
