#include "core/detect/common_blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace waymark {
namespace {

/// A marker whose sides show `blur_px` to ± `fit_sigma` of ln blur.
RefinedCorners marker_with(double blur_px, double fit_sigma, double saturated_share = 0) {
  RefinedCorners marker;
  marker.saturated_share = saturated_share;
  for (SideBlur& side : marker.side_blurs) {
    side = {std::log(blur_px), 1 / (fit_sigma * fit_sigma)};
  }
  return marker;
}

TEST(CommonBlur, ThreeMarkersTellItTwoDoNot) {
  CommonBlur blur;
  blur.add(marker_with(0.8, 0.02));
  blur.add(marker_with(0.8, 0.02));
  EXPECT_FALSE(blur.prior());
  blur.add(marker_with(0.8, 0.02));
  ASSERT_TRUE(blur.prior());
  EXPECT_NEAR(blur.prior()->log_px, std::log(0.8), 1e-12);
  blur.clear();
  EXPECT_FALSE(blur.prior());
}

TEST(CommonBlur, SaturatedMarkersAreNotAsked) {
  CommonBlur blur;
  for (int i = 0; i < 3; ++i) blur.add(marker_with(0.8, 0.02, 0.99 * kSaturatedPaper));
  for (int i = 0; i < 9; ++i) blur.add(marker_with(2.0, 0.02, 1.01 * kSaturatedPaper));
  ASSERT_TRUE(blur.prior());
  EXPECT_NEAR(blur.prior()->log_px, std::log(0.8), 1e-12);
}

TEST(CommonBlur, ItsSigmaIsHowFarMarkersDifferBeyondTheirFits) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto sigma_of = [&](double true_sigma, double fit_sigma) {
    CommonBlur blur;
    for (int i = 0; i < 100; ++i) {
      RefinedCorners marker = marker_with(0.8, fit_sigma);
      for (SideBlur& side : marker.side_blurs) {
        side.log_px += std::hypot(true_sigma, fit_sigma) * normal(random);
      }
      blur.add(marker);
    }
    return blur.prior()->log_sigma;
  };
  EXPECT_NEAR(sigma_of(0.2, 0.02), 0.2, 0.03) << "defocus differs from marker to marker";
  EXPECT_LT(sigma_of(0, 0.1), 0.05) << "noise of the fits is not";
}

}  // namespace
}  // namespace waymark
