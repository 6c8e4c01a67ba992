#include "core/detect/gaussian_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace waymark {
namespace {

TEST(GaussianStep, IsTheNormalDistributionToTwoMillionths) {
  for (double x = -5; x < 5; x += 0.001) {
    const GaussianStep step = gaussian_step(x);
    EXPECT_NEAR(step.value, 0.5 * std::erfc(-x / std::numbers::sqrt2), 2e-6) << x;
    EXPECT_NEAR(step.slope, std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi), 4e-6) << x;
  }
}

TEST(GaussianStep, IsCompleteBeyondFiveSigmas) {
  for (const double x : {-1e9, -6.0, -5.0, std::nan("")}) EXPECT_EQ(gaussian_step(x).value, 0) << x;
  for (const double x : {5.0, 6.0, 1e9}) EXPECT_EQ(gaussian_step(x).value, 1) << x;
}

}  // namespace
}  // namespace waymark
