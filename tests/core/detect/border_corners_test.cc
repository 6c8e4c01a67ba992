#include "core/detect/border_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace waymark {
namespace {

TEST(BorderCorners, AreTheBordersOwnAndDivideIt) {
  std::vector<Pixel> border;
  for (std::int16_t i = 0; i < 200; ++i) border.push_back({i, 0});
  for (std::int16_t i = 0; i < 100; ++i) border.push_back({200, i});
  for (std::int16_t i = 0; i < 200; ++i)
    border.push_back({static_cast<std::int16_t>(200 - i), 100});
  for (std::int16_t i = 0; i < 100; ++i) border.push_back({0, static_cast<std::int16_t>(100 - i)});
  EXPECT_EQ(find_border_corners(border, 12), (BorderCorners{0, 200, 300, 500}));
  EXPECT_FALSE(find_border_corners(border, 160)) << "its mean side is 150 px";
  std::reverse(border.begin(), border.end());
  EXPECT_FALSE(find_border_corners(border, 12)) << "round a hole";
  EXPECT_FALSE(find_border_corners(std::span(border).first(10), 12));
}

}  // namespace
}  // namespace waymark
