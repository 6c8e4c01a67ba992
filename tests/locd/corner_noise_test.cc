#include "locd/corner_noise.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace waymark {
namespace {

/// Median of `markers` χ² values of 8 degrees of freedom, scaled to `sigma` of unit variance, less
/// the share that a pose of 6 parameters takes.
double median_of(int markers, double variance_ratio, std::mt19937& random) {
  std::chi_squared_distribution<double> chi2(8);
  std::vector<double> values;
  for (int i = 0; i < markers; ++i) {
    values.push_back(chi2(random) * variance_ratio * (8.0 * markers - 6) / (8.0 * markers));
  }
  std::sort(values.begin(), values.end());
  return 0.5 * (values[static_cast<std::size_t>((markers - 1) / 2)] +
                values[static_cast<std::size_t>(markers / 2)]);
}

TEST(CornerNoise, FindsWhatTheDetectorDoesNotState) {
  for (const double true_model_px : {0.01, 0.1, 0.5}) {
    CornerNoise noise(true);
    std::mt19937 random(1);
    const double stated = 0.05 * 0.05;
    for (int i = 0; i < 800; ++i) {
      const double assumed = stated + noise.model_sigma_px() * noise.model_sigma_px();
      const double ratio = (stated + true_model_px * true_model_px) / assumed;
      const std::array cameras = {CornerNoise::CameraResiduals{median_of(12, ratio, random), 12},
                                  CornerNoise::CameraResiduals{median_of(8, ratio, random), 8}};
      noise.update(cameras, stated);
    }
    const double total = stated + noise.model_sigma_px() * noise.model_sigma_px();
    EXPECT_NEAR(total / (stated + true_model_px * true_model_px), 1.0, 0.08) << true_model_px;
  }
}

TEST(CornerNoise, ACameraThatDisagreesWithItselfIsNotAsked) {
  CornerNoise noise(false);
  for (int i = 0; i < 300; ++i) {
    const double assumed = noise.model_sigma_px() * noise.model_sigma_px();
    const std::array cameras = {CornerNoise::CameraResiduals{7.344 * 0.04 / assumed * 0.95, 20},
                                CornerNoise::CameraResiduals{1e5, 20}};
    noise.update(cameras, 0);
  }
  EXPECT_NEAR(noise.model_sigma_px(), 0.2, 0.02);
}

TEST(CornerNoise, NothingSeenChangesNothing) {
  CornerNoise noise(true);
  const double before = noise.model_sigma_px();
  noise.update({}, 0.01);
  EXPECT_EQ(noise.model_sigma_px(), before);
}

}  // namespace
}  // namespace waymark
