#include "core/capture/frame_set.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <random>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

StampedImage image(int camera, double t_ms) {
  return {camera, Stamp(static_cast<std::int64_t>(t_ms * 1e6))};
}

TEST(FrameSets, NoImagesNoSets) {
  EXPECT_THAT(group_into_frame_sets({}), IsEmpty());
  EXPECT_THAT(one_frame_set_per_image({}), IsEmpty());
}

TEST(FrameSets, ImagesWithinTheToleranceOfTheEarliestMeet) {
  const std::vector<StampedImage> images{image(0, 100), image(1, 101), image(2, 105), image(0, 150),
                                         image(1, 155.001)};
  const auto sets = group_into_frame_sets(images, milliseconds(5));
  ASSERT_EQ(sets.size(), 3U);
  EXPECT_THAT(sets[0].images, ElementsAre(0, 1, 2)) << "exactly at the tolerance belongs";
  EXPECT_THAT(sets[1].images, ElementsAre(3));
  EXPECT_THAT(sets[2].images, ElementsAre(4)) << "1 µs beyond does not";
}

TEST(FrameSets, ToleranceCountsFromTheEarliestNotFromTheLast) {
  const std::vector<StampedImage> images{image(0, 0), image(1, 4), image(2, 8)};
  const auto sets = group_into_frame_sets(images, milliseconds(5));
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_THAT(sets[0].images, ElementsAre(0, 1));
  EXPECT_THAT(sets[1].images, ElementsAre(2));
}

TEST(FrameSets, OneImagePerCamera) {
  // Camera 0 runs at twice the rate: its second image is a set of its own.
  const std::vector<StampedImage> images{image(0, 0), image(0, 2), image(1, 3)};
  const auto sets = group_into_frame_sets(images, milliseconds(5));
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_THAT(sets[0].images, ElementsAre(0, 2));
  EXPECT_THAT(sets[1].images, ElementsAre(1));
}

TEST(FrameSets, StampIsTheLowestNumberedCamerasStamp) {
  const std::vector<StampedImage> images{image(2, 10), image(1, 11), image(3, 12)};
  const auto sets = group_into_frame_sets(images, milliseconds(5));
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_THAT(sets[0].images, ElementsAre(1, 0, 2)) << "by rising camera";
  EXPECT_EQ(sets[0].stamp, milliseconds(11));
}

TEST(FrameSets, RisingByStamp) {
  // The first set's earliest image is camera 1's, its stamp camera 0's, after the second set's.
  const std::vector<StampedImage> images{image(1, 0), image(1, 2), image(0, 4)};
  const auto sets = group_into_frame_sets(images, milliseconds(5));
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_EQ(sets[0].stamp, milliseconds(2));
  EXPECT_EQ(sets[1].stamp, milliseconds(4));
}

TEST(FrameSets, ZeroToleranceJoinsEqualStampsOnly) {
  const std::vector<StampedImage> images{image(0, 1), image(1, 1), image(2, 1.00001)};
  const auto sets = group_into_frame_sets(images, Stamp::zero());
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_THAT(sets[0].images, ElementsAre(0, 1));
}

TEST(FrameSets, AnyEpochEvenTheEndsOfTheRange) {
  const std::vector<StampedImage> images{{0, Stamp(std::numeric_limits<std::int64_t>::min())},
                                         {1, Stamp(std::numeric_limits<std::int64_t>::max())},
                                         {2, Stamp(-1)},
                                         {3, Stamp(1)}};
  const auto sets = group_into_frame_sets(images);
  ASSERT_EQ(sets.size(), 3U);
  EXPECT_THAT(sets[0].images, ElementsAre(0));
  EXPECT_THAT(sets[1].images, ElementsAre(2, 3));
  EXPECT_THAT(sets[2].images, ElementsAre(1));
}

TEST(FrameSets, OrderOfTheInputLeavesNoTrace) {
  std::mt19937 random(7);
  std::vector<StampedImage> images;
  for (int instant = 0; instant < 50; ++instant) {
    for (int camera = 0; camera < 4; ++camera) {
      const double jitter_ms = std::uniform_real_distribution(-4.0, 4.0)(random);
      if (random() % 5 != 0) images.push_back(image(camera, 20.0 * instant + jitter_ms));
    }
  }
  const auto expected = group_into_frame_sets(images);
  for (int round = 0; round < 5; ++round) {
    std::vector<StampedImage> shuffled = images;
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    const auto sets = group_into_frame_sets(shuffled);
    ASSERT_EQ(sets.size(), expected.size());
    for (std::size_t i = 0; i < sets.size(); ++i) {
      EXPECT_EQ(sets[i].stamp, expected[i].stamp);
      ASSERT_EQ(sets[i].images.size(), expected[i].images.size());
      for (std::size_t j = 0; j < sets[i].images.size(); ++j) {
        EXPECT_EQ(shuffled[sets[i].images[j]].stamp, images[expected[i].images[j]].stamp);
        EXPECT_EQ(shuffled[sets[i].images[j]].camera, images[expected[i].images[j]].camera);
      }
    }
  }
}

TEST(FrameSets, MonoTakesEveryImageAlone) {
  const std::vector<StampedImage> images{image(1, 5), image(0, 5), image(0, 1)};
  const auto sets = one_frame_set_per_image(images);
  ASSERT_EQ(sets.size(), 3U);
  EXPECT_THAT(sets[0].images, ElementsAre(2));
  EXPECT_THAT(sets[1].images, ElementsAre(1));
  EXPECT_THAT(sets[2].images, ElementsAre(0));
  EXPECT_EQ(sets[2].stamp, milliseconds(5));
}

}  // namespace
}  // namespace waymark
