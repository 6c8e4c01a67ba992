#include "core/geometry/decompositions.h"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/symmetric_factor.h"

namespace waymark {
namespace {

/// Symmetric positive definite, of eigenvalues between 0.1 and some hundreds.
template <int N>
Eigen::Matrix<double, N, N> random_information(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto root = Eigen::Matrix<double, N, N>::NullaryExpr([&] { return normal(random); }).eval();
  return root * root.transpose() + 0.1 * Eigen::Matrix<double, N, N>::Identity();
}

template <int N>
void expect_solutions() {
  std::mt19937 random(N);
  for (int trial = 0; trial < 20; ++trial) {
    const auto a = random_information<N>(random);
    const auto x = Eigen::Matrix<double, N, 1>::LinSpaced(N, -1.0, 2.0).eval();
    const SymmetricFactor<N> factor(a);
    EXPECT_LT((factor.solve(a * x) - x).norm(), 1e-9) << N;
    EXPECT_LT((factor.inverse() * a - Eigen::Matrix<double, N, N>::Identity()).norm(), 1e-9) << N;
    EXPECT_LT((factor.solve_columns(a) - Eigen::Matrix<double, N, N>::Identity()).norm(), 1e-9);
  }
}

TEST(SymmetricFactor, SolvesAndInverts) {
  expect_solutions<3>();
  expect_solutions<6>();
  expect_solutions<7>();
  expect_solutions<12>();
}

TEST(Decompositions, EigenvectorsAscendAndComposeTheMatrix) {
  std::mt19937 random(5);
  const Matrix6d a = random_information<6>(random);
  const SymmetricEigen<6> eigen = symmetric_eigen<6>(a);
  const Matrix6d composed = eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose();
  EXPECT_LT((composed - a).norm(), 1e-10);
  EXPECT_TRUE(std::is_sorted(eigen.values.begin(), eigen.values.end()));
  EXPECT_LT((symmetric_eigenvalues<6>(a) - eigen.values).norm(), 1e-10);
}

TEST(Decompositions, SingularVectorsDiagonalize) {
  Eigen::Matrix3d a;
  a << 1, 2, 3, -4, 5, 6, 7, -8, 10;
  const SingularVectors svd = singular_vectors(a);
  const Eigen::Matrix3d s = svd.u.transpose() * a * svd.v;
  EXPECT_LT((s - Eigen::Matrix3d(s.diagonal().asDiagonal())).norm(), 1e-12);
  EXPECT_GE(s(0, 0), s(1, 1));
  EXPECT_GE(s(1, 1), s(2, 2));
  EXPECT_GE(s(2, 2), 0);
}

TEST(Decompositions, LargestSingularValueIsTheLongestImageOfAUnitVector) {
  Eigen::Matrix2d a;
  a << 3, 1, -2, 0.5;
  double longest = 0;
  for (int i = 0; i < 20000; ++i) {
    const double angle = i * 1e-3;
    longest = std::max(longest, (a * Eigen::Vector2d(std::cos(angle), std::sin(angle))).norm());
  }
  EXPECT_NEAR(largest_singular_value(a), longest, 1e-5);
}

TEST(Decompositions, InverseOfSix) {
  std::mt19937 random(6);
  const Matrix6d a = random_information<6>(random);
  EXPECT_LT((inverse(a) * a - Matrix6d::Identity()).norm(), 1e-10);
}

TEST(Decompositions, ShortestRotationTurnsOneIntoTheOther) {
  const Eigen::Vector3d from(1, -2, 0.5);
  const Eigen::Vector3d to(0.3, 4, 1);
  const Eigen::Quaterniond turn = shortest_rotation(from, to);
  EXPECT_LT((turn * from.normalized() - to.normalized()).norm(), 1e-14);
  EXPECT_NEAR(turn.vec().normalized().dot(from.normalized()), 0, 1e-12);
  EXPECT_LT((shortest_rotation(from, -from) * from + from).norm(), 1e-12);
}

}  // namespace
}  // namespace waymark
