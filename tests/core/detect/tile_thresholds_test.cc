#include "core/detect/tile_thresholds.h"

#include <gtest/gtest.h>

#include <random>

namespace waymark {
namespace {

/// Dark to the left of x = 32, light from there on.
GrayImage step_image(std::uint8_t dark, std::uint8_t light) {
  GrayImage image(64, 48, dark);
  for (int y = 0; y < 48; ++y) std::fill(image.row(y) + 32, image.row(y) + 64, light);
  return image;
}

void add_noise(GrayImage& image, int first_column, double sigma) {
  std::mt19937 generator(7);
  std::normal_distribution<double> noise(0, sigma);
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = first_column; x < image.width_px; ++x) {
      const double grey = image.row(y)[x] + noise(generator);
      image.row(y)[x] = static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0));
    }
  }
}

int tiles_with_threshold(const TileThresholds& thresholds) {
  int count = 0;
  for (int row = 0; row < thresholds.rows(); ++row) {
    for (int column = 0; column < thresholds.columns(); ++column) {
      if (thresholds.row(row)[column] != TileThresholds::kNone) ++count;
    }
  }
  return count;
}

TEST(TileThresholds, LieFiveEighthsUpBesideAnEdgeAndAreNoneElsewhere) {
  ContrastGates gates;
  TileThresholds thresholds;
  thresholds.measure(step_image(50, 200).view(), gates);
  EXPECT_EQ(thresholds.columns(), 16);
  EXPECT_EQ(thresholds.rows(), 12);
  for (const int x : {28, 31, 32, 35}) EXPECT_EQ(thresholds.at_pixel(x, 20), 144) << x;
  for (const int x : {0, 23, 40, 63}) EXPECT_EQ(thresholds.at_pixel(x, 20), TileThresholds::kNone);
  EXPECT_EQ(thresholds.middle_at_pixel(2, 2), 50);
}

TEST(TileThresholds, OfLessContrastThanTheGateThereAreNone) {
  ContrastGates gates;
  TileThresholds thresholds;
  thresholds.measure(step_image(100, 119).view(), gates);
  EXPECT_EQ(tiles_with_threshold(thresholds), 0);
  thresholds.measure(step_image(100, 120).view(), gates);
  EXPECT_EQ(tiles_with_threshold(thresholds), 2 * 12);
}

TEST(TileThresholds, NoiseAloneHasHardlyAny) {
  for (const double sigma : {2.0, 6.0}) {
    GrayImage image(400, 400, 120);
    add_noise(image, 0, sigma);
    ContrastGates gates;
    TileThresholds thresholds;
    thresholds.measure(image.view(), gates);
    EXPECT_LT(tiles_with_threshold(thresholds), 10) << sigma;
    EXPECT_GT(gates.gate_grey(), 6 * sigma);
  }
}

TEST(TileThresholds, WhereAnImageIsDarkAndQuietLessContrastCounts) {
  GrayImage image(600, 600, 20);
  for (int y = 0; y < 600; ++y) std::fill(image.row(y) + 120, image.row(y) + 600, 200);
  add_noise(image, 120, 8);
  for (int y = 100; y < 400; ++y) std::fill(image.row(y) + 40, image.row(y) + 100, 44);
  ContrastGates gates;
  TileThresholds thresholds;
  thresholds.measure(image.view(), gates);
  EXPECT_GT(gates.gate_grey(), 44 - 20);
  EXPECT_EQ(thresholds.at_pixel(40, 120), 35);
}

TEST(TileThresholds, NarrowTilesAtTheEndAreMeasuredToo) {
  GrayImage image(13, 9, 50);
  for (int y = 0; y < 9; ++y) image.row(y)[12] = 200;
  ContrastGates gates;
  TileThresholds thresholds;
  thresholds.measure(image.view(), gates);
  EXPECT_EQ(thresholds.columns(), 4);
  EXPECT_EQ(thresholds.rows(), 3);
  EXPECT_EQ(thresholds.at_pixel(12, 8), 144);
  thresholds.measure(GrayImage(4, 4, 9).view(), gates);
  EXPECT_EQ(tiles_with_threshold(thresholds), 0);
}

}  // namespace
}  // namespace waymark
