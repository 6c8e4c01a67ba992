#include "locd/pose/corner_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace waymark {
namespace {

/// Median of `markers` χ² values of 8 degrees of freedom each, less the 6 that a pose takes of all.
double median_of(int markers, double variance_ratio, std::mt19937& random) {
  std::chi_squared_distribution<double> chi2(8 - 6.0 / markers);
  std::vector<double> values;
  for (int i = 0; i < markers; ++i) {
    values.push_back(chi2(random) * variance_ratio);
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

TEST(CornerNoise, AFewMarkersTellItAsTrulyAsMany) {
  for (const int markers : {2, 3, 4, 5, 7, 8, 12, 30}) {
    CornerNoise noise(false);
    std::mt19937 random(2);
    double sum = 0;
    constexpr int kSets = 3000;
    for (int i = 0; i < kSets; ++i) {
      const double assumed = noise.model_sigma_px() * noise.model_sigma_px();
      const std::array cameras = {
          CornerNoise::CameraResiduals{median_of(markers, 0.04 / assumed, random), markers}};
      noise.update(cameras, 0);
      if (i >= kSets / 2) sum += noise.model_sigma_px() * noise.model_sigma_px();
    }
    EXPECT_NEAR(sum / (kSets / 2) / 0.04, 1.0, 0.04) << markers;
  }
}

TEST(CornerNoise, WhereTheDetectorIsRightItsVarianceIsNotRaised) {
  CornerNoise noise(true);
  std::mt19937 random(3);
  const double stated = 0.1 * 0.1;
  double sum = 0;
  constexpr int kSets = 3000;
  for (int i = 0; i < kSets; ++i) {
    const double assumed = stated + noise.model_sigma_px() * noise.model_sigma_px();
    const std::array cameras = {
        CornerNoise::CameraResiduals{median_of(3, stated / assumed, random), 3}};
    noise.update(cameras, stated);
    if (i >= kSets / 2) sum += noise.model_sigma_px() * noise.model_sigma_px();
  }
  EXPECT_LT(sum / (kSets / 2), 0.03 * stated);
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
