#include "core/detect/dark_pixels.h"

#include <gtest/gtest.h>

#include <bit>

namespace waymark {
namespace {

DarkPixels dark_pixels(const GrayImage& image) {
  ContrastGates gates;
  TileThresholds thresholds;
  thresholds.measure(image.view(), gates);
  DarkPixels dark;
  dark.find(image.view(), thresholds, image.width_px);
  return dark;
}

std::vector<std::pair<int, int>> starts_of(const DarkPixels& dark) {
  std::vector<std::pair<int, int>> starts;
  for (int y = 0; y < dark.height_px(); ++y) {
    for (int x = 0; x < dark.width_px(); ++x) {
      const auto bit = static_cast<std::size_t>(dark.bit_of(x, y));
      if ((dark.starts()[bit / 64] >> (bit % 64) & 1U) != 0) starts.emplace_back(x, y);
    }
  }
  return starts;
}

void paint(GrayImage& image, int x0, int y0, int x1, int y1, std::uint8_t grey) {
  for (int y = y0; y < y1; ++y) std::fill(image.row(y) + x0, image.row(y) + x1, grey);
}

TEST(DarkPixels, AreThoseBelowTheirTilesThreshold) {
  GrayImage image(150, 40, 220);
  paint(image, 60, 10, 80, 30, 30);  // across a word's end
  const DarkPixels dark = dark_pixels(image);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 150; ++x) {
      // The middle is farther from an edge than tiles look.
      const bool near = x < 64 || x >= 76 || y < 12 || y >= 28;
      if (!near) continue;
      EXPECT_EQ(dark.is_dark(x, y), x >= 60 && x < 80 && y >= 10 && y < 30) << x << ' ' << y;
    }
  }
}

TEST(DarkPixels, AnAreaBeginsAtItsUppermostLeft) {
  GrayImage image(150, 40, 220);
  paint(image, 62, 9, 72, 19, 30);
  EXPECT_EQ(starts_of(dark_pixels(image)), (std::vector{std::pair(62, 9)}));
}

TEST(DarkPixels, AreasThatTouchAtACornerBeginEach) {
  GrayImage image(40, 40, 220);
  paint(image, 8, 8, 14, 14, 30);
  paint(image, 14, 14, 20, 20, 30);
  EXPECT_EQ(starts_of(dark_pixels(image)), (std::vector{std::pair(8, 8), std::pair(14, 14)}));
}

TEST(DarkPixels, NothingBeginsInsideWhatIsDarkWithoutThreshold) {
  GrayImage image(200, 200, 220);
  paint(image, 40, 40, 160, 160, 30);
  EXPECT_EQ(starts_of(dark_pixels(image)), (std::vector{std::pair(40, 40)}));
}

TEST(DarkPixels, AtTheImagesEdgesHaveNothingOutside) {
  GrayImage image(64, 64, 220);
  paint(image, 0, 0, 6, 64, 30);
  paint(image, 58, 0, 64, 64, 30);
  const DarkPixels dark = dark_pixels(image);
  EXPECT_TRUE(dark.is_dark(0, 63));
  EXPECT_TRUE(dark.is_dark(63, 0));
  EXPECT_EQ(starts_of(dark), (std::vector{std::pair(0, 0), std::pair(58, 0)}));
}

TEST(DarkPixels, OfALargerImageDoNotStayInASmallerOnes) {
  ContrastGates gates;
  TileThresholds thresholds;
  DarkPixels dark;
  for (const int size : {200, 70, 200}) {
    GrayImage image(size, size, 220);
    paint(image, 20, 20, 30, 30, 30);
    thresholds.measure(image.view(), gates);
    dark.find(image.view(), thresholds, image.width_px);
    EXPECT_EQ(starts_of(dark).size(), 1U) << size;
  }
}

}  // namespace
}  // namespace waymark
