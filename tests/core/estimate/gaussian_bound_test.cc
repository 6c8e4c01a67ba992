#include "core/estimate/gaussian_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace waymark {
namespace {

TEST(GaussianBound, QuantilesAreThoseOfTables) {
  EXPECT_NEAR(normal_quantile(0.025), 1.959964, 1e-5);
  const TailRisk risk(1e-5);
  EXPECT_NEAR(risk.chi[0], 4.417173, 1e-5);
  EXPECT_NEAR(risk.chi[1], 4.798526, 1e-5);
  EXPECT_NEAR(risk.chi[2], 5.089376, 1e-4);
}

/// A covariance of these sigmas, and how often its bound at one in a hundred is exceeded.
class Bounds : public testing::TestWithParam<Eigen::Vector3d> {};

TEST_P(Bounds, AreExceededAsSeldomAsTheyAreTo) {
  const TailRisk risk(0.01);
  const Eigen::Vector3d sigmas = GetParam();
  const double in_space = gaussian_bound<3>(Eigen::Matrix3d(sigmas.cwiseAbs2().asDiagonal()), risk);
  const double in_plane =
      gaussian_bound<2>(Eigen::Matrix2d(sigmas.head<2>().cwiseAbs2().asDiagonal()), risk);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  constexpr int kDrawn = 100'000;
  int beyond_in_space = 0;
  int beyond_in_plane = 0;
  for (int i = 0; i < kDrawn; ++i) {
    const Eigen::Vector3d v =
        sigmas.cwiseProduct(Eigen::Vector3d(normal(random), normal(random), normal(random)));
    beyond_in_space += v.norm() > in_space ? 1 : 0;
    beyond_in_plane += v.head<2>().norm() > in_plane ? 1 : 0;
  }
  const double scatter = 4 * std::sqrt(0.01 / kDrawn);
  EXPECT_LT(static_cast<double>(beyond_in_space) / kDrawn, 0.01 + scatter);
  EXPECT_LT(static_cast<double>(beyond_in_plane) / kDrawn, 0.01 + scatter);
  // And not far too wide.
  EXPECT_LE(in_space, risk.chi[2] * sigmas.maxCoeff() + 1e-9);
  EXPECT_LE(in_plane, risk.chi[1] * sigmas.head<2>().maxCoeff() + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(GaussianBound, Bounds,
                         testing::Values(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 0.5, 0.1),
                                         Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.3, 0.29, 2)));

TEST(GaussianBound, OfNothingKnownIsInfinite) {
  const Eigen::Matrix2d unknown = Eigen::Matrix2d::Constant(std::nan(""));
  EXPECT_TRUE(std::isinf(gaussian_bound<2>(unknown, TailRisk(1e-5))));
  EXPECT_EQ(gaussian_bound<2>(Eigen::Matrix2d(Eigen::Matrix2d::Zero()), TailRisk(1e-5)), 0);
}

}  // namespace
}  // namespace waymark
