#include "mapbuilder/observations/observations.h"

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

TEST(Observations, HoldsEveryDetectionOnce) {
  const auto room = test::make_room({});
  std::size_t detections = 0;
  for (const auto& image : room.images) detections += image.detections.size();
  const auto observations = test::observations_of(room);
  EXPECT_EQ(observations.usable, detections);
  EXPECT_EQ(observations.frame_sets.size(), 60U);
  EXPECT_EQ(observations.all.size(), detections);
  std::size_t in_sets = 0;
  for (const ObservedFrameSet& set : observations.frame_sets) in_sets += set.observations.size();
  EXPECT_EQ(in_sets, detections);
}

TEST(Observations, MonoMakesEveryImageAFrame) {
  const auto room = test::make_room({});
  const auto observations = test::observations_of(room, {true, 1});
  EXPECT_EQ(observations.frame_sets.size(), room.images.size());
  EXPECT_EQ(observations.rigs.size(), 3U);
  for (const auto& rig : observations.rigs) {
    EXPECT_EQ(rig.cameras.front().rig_from_cam.translation.norm(), 0);
  }
}

TEST(Observations, AnIdTwiceInOneImageIsNotUsed) {
  auto room = test::make_room({});
  ImageDetections* image = nullptr;
  for (auto& candidate : room.images) {
    if (candidate.detections.size() >= 3) image = &candidate;
  }
  ASSERT_NE(image, nullptr);
  const std::size_t before = test::observations_of(room).usable;
  image->detections[1].marker = image->detections[0].marker;
  const auto observations = test::observations_of(room);
  EXPECT_EQ(observations.repeated_in_image, 2U);
  EXPECT_EQ(observations.usable, before - 2);
  EXPECT_EQ(observations.all.size(), before) << "a finished map may tell which is right";
}

TEST(Observations, SizesThatDisagreeAndRigsWithoutTransformsAreRefused) {
  const auto room = test::make_room({});
  auto other = test::capture_of(room, "other");
  MarkerCatalog::FamilyEntry family = room.catalog.entries().front();
  family.default_size_m = 0.25;
  other.catalog = MarkerCatalog({family});
  const auto sizes = make_observations({test::capture_of(room), other}, {});
  ASSERT_FALSE(sizes);
  EXPECT_EQ(sizes.error().kind, ErrorKind::bad_data);

  auto loose = test::capture_of(room);
  loose.rig.has_extrinsics = false;
  EXPECT_EQ(make_observations({loose}, {}).error().kind, ErrorKind::bad_data);
  EXPECT_TRUE(make_observations({loose}, {true, 1}));
  EXPECT_EQ(make_observations({}, {}).error().kind, ErrorKind::usage);
  EXPECT_EQ(make_observations({test::capture_of(room), test::capture_of(room)}, {}).error().kind,
            ErrorKind::usage);
}

}  // namespace
}  // namespace waymark
