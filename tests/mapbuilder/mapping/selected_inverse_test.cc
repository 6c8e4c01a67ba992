#include "mapbuilder/mapping/selected_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace waymark {
namespace {

/// A random sparse positive definite matrix: a band with a few far entries.
Eigen::SparseMatrix<double> random_matrix(int n, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = std::max(0, i - 3); j < i; ++j) dense(i, j) = normal(random);
    if (i % 7 == 0 && i > 10) dense(i, i - 10) = normal(random);
  }
  const Eigen::MatrixXd symmetric = dense + dense.transpose();
  return (symmetric + 12 * Eigen::MatrixXd::Identity(n, n)).sparseView();
}

TEST(SelectedInverse, AgreesWithTheDenseInverseOnThePattern) {
  std::mt19937 random(21);
  for (const int n : {1, 2, 30, 80}) {
    const auto a = random_matrix(n, random);
    const auto selected = SelectedInverse::compute(a);
    ASSERT_TRUE(selected);
    const Eigen::MatrixXd inverse = Eigen::MatrixXd(a).inverse();
    for (int c = 0; c < a.outerSize(); ++c) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(a, c); it; ++it) {
        const auto row = static_cast<int>(it.row());
        EXPECT_NEAR((*selected)(row, c), inverse(row, c), 1e-12);
      }
    }
    const Eigen::MatrixXd b = Eigen::MatrixXd::Random(n, 3);
    EXPECT_LT((selected->solve(b) - inverse * b).norm(), 1e-11);
  }
}

TEST(SelectedInverse, RefusesWhatIsNotPositiveDefinite) {
  Eigen::MatrixXd indefinite = Eigen::MatrixXd::Identity(3, 3);
  indefinite(1, 1) = -1;
  EXPECT_FALSE(SelectedInverse::compute(indefinite.sparseView()));
  indefinite(1, 1) = 0;
  EXPECT_FALSE(SelectedInverse::compute(indefinite.sparseView()));
}

}  // namespace
}  // namespace waymark
