#include "core/estimate/robust_loss.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(RobustLoss, IsQuadraticForSmallResiduals) {
  for (const Loss loss : {Loss::squared, Loss::huber, Loss::tukey}) {
    EXPECT_NEAR(robust_cost(loss, 6.0, 1e-4), 1e-4, 1e-8);
    EXPECT_NEAR(robust_weight(loss, 6.0, 1e-6), 1.0, 1e-6);
  }
}

TEST(RobustLoss, WeightIsTheDerivativeOfTheCost) {
  for (const Loss loss : {Loss::squared, Loss::huber, Loss::tukey}) {
    for (const double s : {0.5, 20.0, 35.9, 36.1, 100.0}) {
      const double h = 1e-5;
      const double numeric =
          (robust_cost(loss, 6.0, s + h) - robust_cost(loss, 6.0, s - h)) / (2 * h);
      EXPECT_NEAR(robust_weight(loss, 6.0, s), numeric, 1e-7) << s;
    }
  }
}

TEST(RobustLoss, HuberGrowsLinearlyAndTukeyNotAtAllBeyondTheScale) {
  EXPECT_DOUBLE_EQ(robust_cost(Loss::huber, 6.0, 3600.0), 2 * 6 * 60.0 - 36);
  EXPECT_DOUBLE_EQ(robust_cost(Loss::tukey, 6.0, 1e6), robust_cost(Loss::tukey, 6.0, 36.0));
  EXPECT_EQ(robust_weight(Loss::tukey, 6.0, 36.1), 0.0);
}

}  // namespace
}  // namespace waymark
