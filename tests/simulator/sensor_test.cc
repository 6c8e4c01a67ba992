#include "simulator/sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace waymark::simulator {
namespace {

/// Settings whose grey level is 255 times the light, without vignetting and noise.
RenderSettings plain_settings() {
  RenderSettings settings;
  settings.white_level = 255 * settings.white_albedo;
  settings.vignetting = 0;
  settings.noise = false;
  return settings;
}

IrradianceImage flat(float light, int side_px = 64) {
  return {side_px, side_px,
          std::vector<float>(static_cast<std::size_t>(side_px) * static_cast<std::size_t>(side_px),
                             light)};
}

int grey_of(const RenderSettings& settings, float light) {
  return Sensor(settings).expose(flat(light, 8), 1).row(4)[4];
}

TEST(Sensor, IsLinearUntilItSaturates) {
  const RenderSettings settings = plain_settings();
  EXPECT_EQ(grey_of(settings, 0.0F), 0);
  EXPECT_EQ(grey_of(settings, 0.2F), 51);
  EXPECT_EQ(grey_of(settings, 0.4F), 102);
  EXPECT_EQ(grey_of(settings, 1.0F), 255);
  EXPECT_EQ(grey_of(settings, 1.7F), 255);
}

TEST(Sensor, TheSrgbResponseIsTheStandardsCurve) {
  RenderSettings settings = plain_settings();
  settings.response = Response::srgb;
  // IEC 61966-2-1: 1.055 L^(1/2.4) − 0.055 above 0.0031308, 12.92 L below.
  EXPECT_EQ(grey_of(settings, 0.0F), 0);
  EXPECT_NEAR(grey_of(settings, 0.002F), 255 * 12.92 * 0.002, 1);
  for (const float light : {0.05F, 0.2140F, 0.5F, 0.8F}) {
    EXPECT_NEAR(grey_of(settings, light), 255 * (1.055 * std::pow(light, 1 / 2.4) - 0.055), 0.6)
        << light;
  }
  EXPECT_EQ(grey_of(settings, 1.0F), 255);
}

TEST(Sensor, TheSrgbResponseMovesABlurredEdgeIntoTheDark) {
  // A Gaussian step of sigma 0.8 px about column 32, black to white.
  IrradianceImage step = flat(0);
  for (int y = 0; y < step.height_px; ++y) {
    for (int x = 0; x < step.width_px; ++x) {
      step.values[static_cast<std::size_t>(y * step.width_px + x)] =
          static_cast<float>(0.05 + 0.8 * 0.5 * std::erfc((32.0 - x) / (0.8 * std::sqrt(2.0))));
    }
  }
  // Where the edge of two plateaus lies that hold as much grey.
  const auto edge_px = [&](const RenderSettings& settings) {
    const GrayImage image = Sensor(settings).expose(step, 1);
    const std::uint8_t* row = image.row(10);
    const double grey = std::accumulate(row, row + step.width_px, 0.0);
    return step.width_px - 0.5 - (grey - row[0] * step.width_px) / (row[63] - row[0]);
  };
  RenderSettings settings = plain_settings();
  EXPECT_NEAR(edge_px(settings), 32.0, 0.02);
  settings.response = Response::srgb;
  EXPECT_LT(edge_px(settings), 31.85);
  EXPECT_GT(edge_px(settings), 31.4);
}

TEST(Sensor, NoiseIsReadNoiseAndShotNoiseTogether) {
  RenderSettings settings = plain_settings();
  settings.noise = true;
  const auto sigma_of = [&](float light) {
    const GrayImage image = Sensor(settings).expose(flat(light, 256), 7);
    double sum = 0;
    double squares = 0;
    for (const std::uint8_t grey : image.pixels) {
      sum += grey;
      squares += static_cast<double>(grey) * grey;
    }
    const auto count = static_cast<double>(image.pixels.size());
    return std::sqrt(squares / count - sum / count * sum / count);
  };
  const double per_electron = 255 / settings.full_well_e;
  for (const float light : {0.2F, 0.7F}) {
    const double electrons = light * settings.full_well_e;
    const double expected =
        std::hypot(per_electron * std::hypot(settings.read_noise_e, std::sqrt(electrons)),
                   1 / std::sqrt(12.0));
    EXPECT_NEAR(sigma_of(light), expected, 0.03 * expected) << light;
  }
  settings.noise = false;
  EXPECT_EQ(sigma_of(0.5F), 0);
}

}  // namespace
}  // namespace waymark::simulator
