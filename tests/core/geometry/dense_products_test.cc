#include "core/geometry/dense_products.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

namespace waymark {
namespace {

using Eigen::MatrixXd;

TEST(DenseProducts, AreTheProducts) {
  for (const Eigen::Index depth : {0, 1, 3, 7, 32, 75}) {
    for (const Eigen::Index rows : {1, 3, 4, 6, 8, 11, 20}) {
      for (const Eigen::Index columns : {1, 2, 3, 4, 9}) {
        const MatrixXd a = MatrixXd::Random(rows, depth);
        const MatrixXd b = MatrixXd::Random(depth, columns);
        const MatrixXd product = MatrixXd::Ones(rows, columns) + a * b;
        MatrixXd c = MatrixXd::Ones(rows, columns);
        add_product(a, b, c);
        EXPECT_LT((c - product).norm(), 1e-12) << rows << "x" << depth << "x" << columns;
        c.setOnes();
        add_transposed_product(a.transpose().eval(), b, c);
        EXPECT_LT((c - product).norm(), 1e-12) << rows << "x" << depth << "x" << columns;
      }
    }
  }
}

TEST(DenseProducts, PartsOfLargerMatricesLeaveTheRest) {
  const MatrixXd a = MatrixXd::Random(30, 30);
  const MatrixXd b = MatrixXd::Random(30, 30);
  MatrixXd c = MatrixXd::Zero(30, 30);
  add_product(a.block(1, 2, 13, 7), b.block(3, 4, 7, 6), c.block(5, 6, 13, 6));
  EXPECT_LT((c.block(5, 6, 13, 6) - a.block(1, 2, 13, 7) * b.block(3, 4, 7, 6)).norm(), 1e-12);
  c.block(5, 6, 13, 6).setZero();
  EXPECT_EQ(c.norm(), 0);
}

TEST(DenseProducts, FactorsAndSolutionsAreEigens) {
  for (const Eigen::Index size : {1, 8, 9, 31, 32, 100, 245}) {
    for (const Eigen::Index columns : {1, 3, 7}) {
      const MatrixXd root = MatrixXd::Random(size, size);
      const MatrixXd matrix = root * root.transpose() + MatrixXd::Identity(size, size);
      MatrixXd factor = matrix;
      ASSERT_TRUE(factor_in_place(factor)) << size;
      const MatrixXd lower = factor.triangularView<Eigen::Lower>();
      EXPECT_LT((lower * lower.transpose() - matrix).norm(), 1e-9 * matrix.norm()) << size;
      const MatrixXd right = MatrixXd::Random(size, columns);
      MatrixXd x = right;
      solve_in_place(factor, x);
      EXPECT_LT((lower * x - right).norm(), 1e-10 * right.norm()) << size;
      x = right;
      solve_transposed_in_place(factor, x);
      EXPECT_LT((lower.transpose() * x - right).norm(), 1e-10 * right.norm()) << size;
    }
  }
}

TEST(DenseProducts, WhatIsNotPositiveDefiniteHasNoFactor) {
  MatrixXd matrix = MatrixXd::Identity(40, 40);
  matrix(35, 35) = -1;
  EXPECT_FALSE(factor_in_place(matrix));
}

}  // namespace
}  // namespace waymark
