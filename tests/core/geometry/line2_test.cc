#include "core/geometry/line2.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(Line2, LinesMeetWhateverTheLengthOfTheirDirections) {
  const auto place = intersection({{0, 1}, {3, 0}}, {{2, -5}, {0, -0.5}}, 0.01);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->x(), 2, 1e-12);
  EXPECT_NEAR(place->y(), 1, 1e-12);
}

TEST(Line2, LinesAlmostInParallelDoNotMeet) {
  const Line2 level{{0, 0}, {1, 0}};
  EXPECT_FALSE(intersection(level, {{0, 1}, {100, 1}}, 0.02));
  EXPECT_TRUE(intersection(level, {{0, 1}, {100, 1}}, 0.005));
  EXPECT_FALSE(intersection(level, {{0, 1}, {-1, 0}}, 0));
}

}  // namespace
}  // namespace waymark
