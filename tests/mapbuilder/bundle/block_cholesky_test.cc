#include "mapbuilder/bundle/block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/mapbuilder/bundle/dense_blocks.h"

namespace waymark {
namespace {

/// A random positive definite matrix whose blocks meet in random groups, as markers meet in frame
/// sets: a chain of neighbours with a few far ones.
BlockMatrix random_matrix(int columns, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<std::vector<int>> groups;
  for (int c = 0; c + 1 < columns; ++c) {
    std::vector<int> group{c, c + 1};
    if (c % 7 == 0 && c + 9 < columns) group.push_back(c + 9);
    groups.push_back(group);
  }
  BlockMatrix matrix{pattern_of_groups(columns, groups), {}};
  for (int c = 0; c < columns; ++c) {
    for (int b = matrix.pattern.first[static_cast<std::size_t>(c)];
         b < matrix.pattern.first[static_cast<std::size_t>(c) + 1]; ++b) {
      Matrix6d block = Matrix6d::NullaryExpr([&] { return normal(random); });
      if (matrix.pattern.rows[static_cast<std::size_t>(b)] == c) {
        block = (block * block.transpose()).eval() + 60 * Matrix6d::Identity();
      }
      matrix.blocks.push_back(block);
    }
  }
  return matrix;
}

TEST(BlockPattern, GroupsMeetWithinThemselvesAndNowhereElse) {
  const BlockPattern pattern = pattern_of_groups(5, {{0, 3}, {1, 3, 4}, {0, 3}});
  EXPECT_EQ(pattern.columns(), 5);
  EXPECT_EQ(pattern.blocks(), 5U + 1U + 3U);
  EXPECT_GE(pattern.find(3, 0), 0);
  EXPECT_GE(pattern.find(4, 1), 0);
  EXPECT_EQ(pattern.find(4, 0), -1);
  EXPECT_EQ(pattern.rows[static_cast<std::size_t>(pattern.find(2, 2))], 2);
}

TEST(BlockCholesky, SolvesAndInvertsAsTheDenseMatrix) {
  std::mt19937 random(21);
  for (const int columns : {1, 2, 13, 40}) {
    const BlockMatrix a = random_matrix(columns, random);
    const Eigen::MatrixXd inverse = test::dense(a).inverse();
    BlockCholesky cholesky(a.pattern);
    ASSERT_TRUE(cholesky.factorize(a));
    const Eigen::MatrixXd b = Eigen::MatrixXd::Random(6 * columns, 3);
    EXPECT_LT((cholesky.solve(b) - inverse * b).norm(), 1e-11);
    const std::vector<Matrix6d> diagonal = cholesky.inverse_diagonal();
    ASSERT_EQ(diagonal.size(), static_cast<std::size_t>(columns));
    for (int c = 0; c < columns; ++c) {
      const Matrix6d expected = inverse.block<6, 6>(6 * c, 6 * c);
      EXPECT_LT((diagonal[static_cast<std::size_t>(c)] - expected).norm(), 1e-12);
    }
  }
}

TEST(BlockCholesky, ServesManyMatricesOfOnePattern) {
  std::mt19937 random(5);
  const BlockMatrix first = random_matrix(20, random);
  BlockMatrix second = random_matrix(20, random);
  BlockCholesky cholesky(first.pattern);
  ASSERT_TRUE(cholesky.factorize(first));
  ASSERT_TRUE(cholesky.factorize(second));
  const Eigen::VectorXd b = Eigen::VectorXd::Random(120);
  EXPECT_LT((test::dense(second) * cholesky.solve(b) - b).norm(), 1e-10);
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefinite) {
  std::mt19937 random(6);
  BlockMatrix matrix = random_matrix(4, random);
  matrix.blocks[0] = -matrix.blocks[0];
  BlockCholesky cholesky(matrix.pattern);
  EXPECT_FALSE(cholesky.factorize(matrix));
  matrix.blocks[0].setZero();
  EXPECT_FALSE(cholesky.factorize(matrix));
}

}  // namespace
}  // namespace waymark
