#include "simulator/point_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace waymark::simulator {
namespace {

class PointSpreads : public testing::TestWithParam<int> {};

TEST_P(PointSpreads, KeepTheLightAndItsPlace) {
  const int oversampling = GetParam();
  constexpr double kSigma = 0.7;
  const auto radius = static_cast<std::size_t>(PointSpread::radius_px(kSigma));
  const PointSpread spread(kSigma, oversampling);
  EXPECT_EQ(spread.oversampling(), oversampling);
  constexpr std::size_t kCount = 21;
  const std::size_t stride = kCount + 2 * radius;
  const auto n = static_cast<std::size_t>(oversampling);
  // Every sub-pixel as bright: so is every pixel.
  std::vector<float> phases(stride * n, 3.0F);
  std::vector<float> out(kCount);
  spread.reduce_row(phases.data(), stride, kCount, out.data());
  for (const float pixel : out) EXPECT_NEAR(pixel, 3, 1e-5);
  // One bright pixel in the middle: its light is spread evenly to both sides and none is lost.
  std::fill(phases.begin(), phases.end(), 0.0F);
  for (std::size_t p = 0; p < n; ++p) phases[p * stride + radius + kCount / 2] = 1;
  spread.reduce_row(phases.data(), stride, kCount, out.data());
  EXPECT_NEAR(std::accumulate(out.begin(), out.end(), 0.0), 1, 1e-5);
  for (std::size_t i = 0; i < kCount / 2; ++i) EXPECT_NEAR(out[i], out[kCount - 1 - i], 1e-6);
  EXPECT_GT(out[kCount / 2], out[kCount / 2 - 1]);
}

INSTANTIATE_TEST_SUITE_P(PointSpread, PointSpreads, testing::Values(1, 2, 4, 8));

}  // namespace
}  // namespace waymark::simulator
