#include "mapbuilder/observations/selection.h"

#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

TEST(Selection, HoldsWhatNoCorrectionLeavesOutAndTheSizesItGives) {
  const auto room = test::make_room({});
  const Observations observations = test::observations_of(room);
  Corrections corrections;
  corrections.left_out = {ObservationIndex(3), ObservationIndex(40)};
  corrections.sizes_m[MarkerIndex(2)] = 0.25;
  const Selection selection(observations, corrections);
  EXPECT_EQ(selection.used().size(), observations.usable - 2);
  ASSERT_EQ(selection.unused().size(), 2U);
  EXPECT_EQ(selection.unused()[0], ObservationIndex(3));
  EXPECT_EQ(selection.stated_sizes_m()[MarkerIndex(2)], 0.25);
  EXPECT_EQ(observations.stated_sizes_m[MarkerIndex(2)], 0.3) << "what was stated stays";
}

TEST(Selection, FrameSetsAndMarkersHoldEveryUsedObservationOnce) {
  const auto room = test::make_room({});
  const Observations observations = test::observations_of(room);
  const Selection selection(observations, {{ObservationIndex(0), ObservationIndex(7)}, {}});
  std::vector<ObservationIndex> by_set;
  for (const FrameSetIndex f : observations.frame_sets.indices()) {
    for (const ObservationIndex index : selection.used_in(f)) {
      EXPECT_EQ(selection[index].frame_set, f);
      by_set.push_back(index);
    }
  }
  EXPECT_TRUE(
      std::equal(by_set.begin(), by_set.end(), selection.used().begin(), selection.used().end()));
  std::size_t by_marker = 0;
  for (const MarkerIndex m : observations.markers.indices()) {
    by_marker += selection.used_of(m).size();
    for (const ObservationIndex index : selection.used_of(m)) EXPECT_EQ(selection[index].marker, m);
  }
  EXPECT_EQ(by_marker, selection.used().size());
}

TEST(Selection, AnIdFoundTwiceInOneImageIsUnused) {
  auto room = test::make_room({});
  for (auto& image : room.images) {
    if (image.detections.size() < 3) continue;
    image.detections[1].marker = image.detections[0].marker;
    break;
  }
  const Observations observations = test::observations_of(room);
  const Selection selection(observations);
  EXPECT_EQ(selection.used().size(), observations.usable);
  EXPECT_EQ(selection.unused().size(), 2U);
}

}  // namespace
}  // namespace waymark
