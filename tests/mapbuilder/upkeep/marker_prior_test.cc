#include "mapbuilder/upkeep/marker_prior.h"

#include <gtest/gtest.h>

#include "core/map/marker_map.h"
#include "mapbuilder/bundle/bundle_variables.h"

namespace waymark {
namespace {

const Rigid3 kPlace{so3_exp(Eigen::Vector3d(0.3, -1, 2)), {4, 5, 6}};

/// ½ the squared residual with the marker moved by δ.
Eigen::VectorXd residual(const Matrix6d& covariance, const Vector6d& delta) {
  BundleVariables at;
  at.world_from_marker = {Rigid3{}, kPlace.plus(delta)};
  return MarkerPrior(1, kPlace, covariance).linearize(at).residual;
}

Matrix6d some_covariance() {
  Matrix6d root = Matrix6d::Identity();
  root(0, 1) = 0.4;
  root(3, 5) = -0.7;
  root(2, 4) = 0.2;
  return 1e-6 * root * root.transpose();
}

TEST(MarkerPrior, IsNothingWhereTheMarkerStood) {
  EXPECT_LT(residual(some_covariance(), Vector6d::Zero()).norm(), 1e-9);
}

TEST(MarkerPrior, IsTheDistanceInSigmas) {
  Vector6d delta;
  delta << 1e-3, -2e-3, 5e-4, 1e-3, 3e-4, -1e-3;
  const double expected = delta.dot(some_covariance().inverse() * delta);
  EXPECT_NEAR(residual(some_covariance(), delta).squaredNorm() / expected, 1.0, 1e-6);
}

TEST(MarkerPrior, ItsJacobianIsThatOfTheResidual) {
  BundleVariables at;
  Vector6d delta;
  delta << 1e-3, -2e-3, 5e-4, 1e-3, 3e-4, -1e-3;
  at.world_from_marker = {kPlace.plus(delta)};
  const MarkerPrior prior(0, kPlace, some_covariance());
  const FactorLinearization here = prior.linearize(at);
  ASSERT_EQ(here.parts.size(), 1U);
  EXPECT_EQ(prior.blocks(), std::vector<int>{0});
  for (int k = 0; k < 6; ++k) {
    BundleVariables there = at;
    const double step = 1e-7;
    there.world_from_marker[0] = at.world_from_marker[0].plus(step * Vector6d::Unit(k));
    const Eigen::VectorXd slope = (prior.linearize(there).residual - here.residual) / step;
    EXPECT_LT((slope - here.parts[0].jacobian.col(k)).norm(), 2e-3 * slope.norm()) << k;
  }
}

TEST(MarkerPrior, NothingIsKnownBetterThanPaperHangs) {
  Matrix6d flat = Matrix6d::Zero();
  flat(0, 0) = 1e-6;
  EXPECT_NEAR(residual(flat, 1e-5 * Vector6d::Unit(1)).norm(), 1.0, 1e-6);
  EXPECT_NEAR(residual(flat, 1e-3 * Vector6d::Unit(0)).norm(), 1.0, 1e-6);
}

TEST(MarkerPrior, AnUnknownCovarianceHoldsTheMarkerToADecimetre) {
  EXPECT_NEAR(residual(unknown_covariance(), 0.1 * Vector6d::Unit(2)).norm(), 1.0, 1e-6);
}

}  // namespace
}  // namespace waymark
