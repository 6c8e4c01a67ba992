#include "mapbuilder/diagnosis/scatter.h"

#include <gtest/gtest.h>

#include <random>

namespace waymark {
namespace {

/// Values that scatter by `spread` about 0.3, each measured with that sigma.
std::vector<Measured> measured(double spread, double sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> behind(0.3, spread);
  std::normal_distribution<double> noise(0, sigma);
  std::vector<Measured> all;
  for (int i = 0; i < 2000; ++i) all.push_back({behind(random) + noise(random), sigma});
  return all;
}

TEST(Scatter, IsWhatLiesBehindTheNoiseWhateverStandsOut) {
  for (const double sigma : {0.001, 0.01, 0.02}) {
    auto all = measured(0.01, sigma);
    for (int i = 0; i < 100; ++i) all.push_back({5, sigma});
    const Scatter scatter = scatter_of(all);
    EXPECT_NEAR(scatter.centre, 0.3, 0.003);
    EXPECT_NEAR(scatter.spread, 0.01, 0.004);  // of 2,000 values half drowned in noise
  }
}

TEST(Scatter, OfNoiseAloneIsSmall) { EXPECT_LT(scatter_of(measured(0, 0.01)).spread, 0.003); }

TEST(Scatter, ExcludesByBothSigmasTogether) {
  const Scatter scatter{1.0, 0.3};
  EXPECT_TRUE(scatter.excludes({1.0 + 6 * 0.5 + 0.01, 0.4}, 6));
  EXPECT_FALSE(scatter.excludes({1.0 - 6 * 0.5 + 0.01, 0.4}, 6));
}

}  // namespace
}  // namespace waymark
