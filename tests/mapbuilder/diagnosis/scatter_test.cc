#include "mapbuilder/diagnosis/scatter.h"

#include <gtest/gtest.h>

#include <random>

namespace waymark {
namespace {

TEST(Scatter, IsOneStandardDeviationWhateverStandsOut) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.3, 0.01);
  std::vector<double> values;
  for (int i = 0; i < 2000; ++i) values.push_back(normal(random));
  for (int i = 0; i < 100; ++i) values.push_back(5);
  const Scatter scatter = scatter_of(values);
  EXPECT_NEAR(scatter.centre, 0.3, 0.002);
  EXPECT_NEAR(scatter.spread, 0.01, 0.001);
}

TEST(Scatter, ExcludesByBothSigmasTogether) {
  const Scatter scatter{1.0, 0.3};
  EXPECT_TRUE(scatter.excludes(1.0 + 6 * 0.5 + 0.01, 0.4, 6));
  EXPECT_FALSE(scatter.excludes(1.0 - 6 * 0.5 + 0.01, 0.4, 6));
}

}  // namespace
}  // namespace waymark
