#include "core/geometry/rigid3.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/numeric_jacobian.h"

namespace waymark {
namespace {

Rigid3 random_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  return {so3_exp(vector()), 5 * vector()};
}

Matrix6d random_covariance(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(random); });
  return root * root.transpose();
}

TEST(Rigid3, CompositionActsAsOneMotionAfterTheOther) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 a_from_b = random_pose(random);
    const Rigid3 b_from_c = random_pose(random);
    const Eigen::Vector3d x_in_c(1, 2, 3);
    EXPECT_TRUE(((a_from_b * b_from_c) * x_in_c).isApprox(a_from_b * (b_from_c * x_in_c), 1e-14));
    EXPECT_TRUE((a_from_b.inverse() * (a_from_b * x_in_c)).isApprox(x_in_c, 1e-14));
  }
}

TEST(Rigid3, MinusUndoesPlus) {
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 pose = random_pose(random);
    const Vector6d delta = 0.5 * Vector6d::Random();
    EXPECT_LT((pose.plus(delta).minus(pose) - delta).norm(), 1e-13);
  }
}

TEST(Rigid3, PlusActsInTargetAxes) {
  const Rigid3 pose{so3_exp({0.4, 1, -2}), {3, 4, 5}};
  Vector6d delta;
  delta << 0.1, 0.2, 0.3, 0.01, -0.02, 0.03;
  const Rigid3 moved = pose.plus(delta);
  EXPECT_TRUE(moved.translation.isApprox(Eigen::Vector3d(3.1, 4.2, 5.3), 1e-15));
  EXPECT_LT(angle_between_rad(moved.rotation, so3_exp({0.01, -0.02, 0.03}) * pose.rotation), 1e-15);
}

TEST(Rigid3, LeftMotionJacobianMatchesNumericDerivative) {
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 b_from_a = random_pose(random);
    const Rigid3 t = random_pose(random);
    const Rigid3 product = b_from_a * t;
    const Matrix6d numeric = test::numeric_jacobian<6, 6>(
        [&](const Vector6d& delta) { return (b_from_a * t.plus(delta)).minus(product); });
    EXPECT_LT((left_motion_jacobian(b_from_a) - numeric).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(Rigid3, InverseCovarianceMatchesNumericDerivative) {
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 t = random_pose(random);
    const Matrix6d covariance = random_covariance(random);
    const Matrix6d numeric = test::numeric_jacobian<6, 6>(
        [&](const Vector6d& delta) { return t.plus(delta).inverse().minus(t.inverse()); });
    const Matrix6d expected = numeric * covariance * numeric.transpose();
    const Matrix6d error = inverse_covariance(t, covariance) - expected;
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-9 * expected.norm());
  }
}

}  // namespace
}  // namespace waymark
