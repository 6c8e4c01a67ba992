#include "core/detect/quad_search.h"

#include <gtest/gtest.h>

#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// Light, with dark squares of 40 px, their upper left pixels at these places.
GrayImage image_with(const std::vector<std::pair<int, int>>& squares) {
  GrayImage image(300, 200, 210);
  for (const auto& [x, y] : squares) {
    for (int row = y; row < y + 40; ++row) {
      std::fill(image.row(row) + x, image.row(row) + x + 40, std::uint8_t{30});
    }
  }
  return image;
}

TEST(QuadSearch, FindsSquaresToAFractionOfAPixel) {
  QuadSearch search;
  const auto& quads = search.find(image_with({{50, 60}, {200, 100}}).view(), 12);
  ASSERT_EQ(quads.size(), 2U);
  EXPECT_LT((centre_of(quads[0]) - Eigen::Vector2d(69.5, 79.5)).norm(), 0.2);
  EXPECT_NEAR(mean_side_px(quads[0]), 40, 0.3);
  EXPECT_TRUE(search.find(image_with({{50, 60}}).view(), 45).empty());
}

TEST(QuadSearch, LooksInWindowsAlone) {
  const GrayImage image = image_with({{50, 60}, {200, 100}});
  QuadSearch search;
  const ImageWindow window{185, 85, 70, 70};
  const std::vector<ImageCorners> quads = search.find(image.view(), 12, {&window, 1});
  ASSERT_EQ(quads.size(), 1U);
  EXPECT_LT((centre_of(quads[0]) - Eigen::Vector2d(219.5, 119.5)).norm(), 0.2);
  const ImageWindow cut{210, 85, 70, 70};
  EXPECT_TRUE(search.find(image.view(), 45, {&cut, 1}).empty());
  const ImageWindow none{400, 0, 70, 70};
  EXPECT_TRUE(search.find(image.view(), 12, {&none, 1}).empty());
}

TEST(QuadSearch, SaysWhatItCanNotSearch) {
  EXPECT_NE(QuadSearch::why_not({nullptr, 64, 64, 64}), nullptr);
  const GrayImage image(64, 64, 90);
  EXPECT_NE(QuadSearch::why_not({image.pixels.data(), 64, 64, 63}), nullptr);
  EXPECT_EQ(QuadSearch::why_not(image.view()), nullptr);
  QuadSearch search;
  EXPECT_TRUE(search.find(GrayImage(3, 90, 100).view(), 12).empty());
}

TEST(ImageWindow, IsCutToTheImageAndBeginsOnTheGrid) {
  const GrayImage image(100, 50);
  const ImageWindow part = within(image.view(), {-7, 13, 50, 90}, 4);
  EXPECT_EQ(part.left_px, 0);
  EXPECT_EQ(part.top_px, 12);
  EXPECT_EQ(part.width_px, 43);
  EXPECT_EQ(part.height_px, 38);
  EXPECT_EQ(within(image.view(), {100, 0, 20, 20}).area_px2(), 0);
  EXPECT_EQ(within(image.view(), {-40, 0, 20, 20}).area_px2(), 0);
}

}  // namespace
}  // namespace waymark
