#include "core/detect/smallest_rectangle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

TEST(SmallestRectangle, GoesFromEdgeToEdge) {
  const std::vector<Pixel> pixels{{10, 20}, {29, 20}, {29, 24}, {10, 24}, {15, 22}};
  const auto rectangle = smallest_rectangle(pixels);
  ASSERT_TRUE(rectangle);
  EXPECT_NEAR(area_px2(*rectangle), 20 * 5, 1e-9);
}

TEST(SmallestRectangle, IsTurnedAsThePixelsAre) {
  std::vector<Pixel> pixels;
  for (int along = 0; along <= 200; along += 5) {
    for (int across = 0; across <= 100; across += 5) {
      const double x = 300 + along * std::cos(0.4) - across * std::sin(0.4);
      const double y = 300 + along * std::sin(0.4) + across * std::cos(0.4);
      pixels.push_back(
          {static_cast<std::int16_t>(std::lround(x)), static_cast<std::int16_t>(std::lround(y))});
    }
  }
  const auto rectangle = smallest_rectangle(pixels);
  ASSERT_TRUE(rectangle);
  EXPECT_NEAR(area_px2(*rectangle), 201 * 101, 0.02 * 201 * 101);
}

TEST(SmallestRectangle, OfPixelsOnALineThereIsNone) {
  EXPECT_FALSE(smallest_rectangle(std::vector<Pixel>{{1, 1}, {2, 2}, {5, 5}}));
  EXPECT_FALSE(smallest_rectangle(std::vector<Pixel>{{1, 1}}));
  EXPECT_FALSE(smallest_rectangle({}));
}

}  // namespace
}  // namespace waymark
