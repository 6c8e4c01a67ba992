#include "core/capture/sync_tolerance.h"

#include <gmock/gmock.h>

#include <tuple>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

StampedImage image(int camera, double t_ms) {
  return {camera, Stamp(static_cast<std::int64_t>(t_ms * 1e6))};
}

/// Two cameras at 200 images a second, of which camera 1 loses its third.
std::vector<StampedImage> two_fast_cameras() {
  std::vector<StampedImage> images;
  for (int i = 0; i < 20; ++i) {
    images.push_back(image(0, 5.0 * i));
    if (i != 2) images.push_back(image(1, 5.0 * i));
  }
  return images;
}

TEST(UsableTolerance, ALostFrameOfFastCamerasPairsNothingWrongly) {
  const std::vector<StampedImage> images = two_fast_cameras();
  const auto usable = usable_tolerance(milliseconds(5), images, 2);
  EXPECT_EQ(usable.tolerance, std::chrono::microseconds(2500));
  ASSERT_TRUE(usable.note);
  EXPECT_NE(usable.note->find("5.000 ms"), std::string::npos) << *usable.note;
  const auto sets = group_into_frame_sets(images, usable.tolerance);
  ASSERT_EQ(sets.size(), 20U);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    EXPECT_EQ(sets[i].images.size(), i == 2 ? 1U : 2U) << i;
    for (const std::size_t member : sets[i].images) {
      EXPECT_EQ(images[member].stamp, sets[i].stamp);
    }
  }
}

TEST(UsableTolerance, IsTheStatedOneWhereThatIsLessThanThePeriodAllows) {
  for (const auto& [stated_ms, period_ms, cameras, usable_us] : {std::tuple{5, 33, 2U, 5'000},
                                                                 {5, 10, 2U, 5'000},
                                                                 {5, 9, 2U, 4'500},
                                                                 {5, 5, 1U, 5'000},
                                                                 {30, 33, 3U, 22'000},
                                                                 {5, 6, 16U, 5'000},
                                                                 {5, 1, 4U, 750}}) {
    const auto usable =
        usable_tolerance(milliseconds(stated_ms), Stamp(milliseconds(period_ms)), cameras);
    EXPECT_EQ(usable.tolerance, std::chrono::microseconds(usable_us)) << period_ms;
    EXPECT_EQ(usable.note.has_value(), usable_us != 1000 * stated_ms) << period_ms;
  }
  EXPECT_EQ(usable_tolerance(milliseconds(5), std::vector{image(0, 1), image(1, 1)}, 2).tolerance,
            milliseconds(5))
      << "one set tells no period";
}

TEST(SpacingsOf, AreThoseOfEachCamera) {
  const std::vector<StampedImage> images{image(1, 9), image(0, 0), image(1, 2),
                                         image(0, 4), image(0, 4), image(2, 1)};
  EXPECT_THAT(spacings_of(images), ElementsAre(milliseconds(4), milliseconds(7)));
}

}  // namespace
}  // namespace waymark
