#include "core/geometry/sliced_products.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

namespace waymark {
namespace {

using Eigen::MatrixXd;

TEST(SlicedProducts, AreTheProducts) {
  for (const Eigen::Index depth : {0, 7, 32, 75}) {
    const MatrixXd a = MatrixXd::Random(20, depth);
    const MatrixXd b = MatrixXd::Random(depth, 9);
    MatrixXd c = MatrixXd::Ones(20, 9);
    add_product(a, b, c);
    EXPECT_LT((c - MatrixXd::Ones(20, 9) - a * b).norm(), 1e-12) << depth;
    c.setOnes();
    add_transposed_product(a.transpose().eval(), b, c);
    EXPECT_LT((c - MatrixXd::Ones(20, 9) - a * b).norm(), 1e-12) << depth;
  }
}

TEST(SlicedProducts, FactorsAndSolutionsAreEigens) {
  for (const Eigen::Index size : {1, 31, 32, 100}) {
    const MatrixXd root = MatrixXd::Random(size, size);
    const MatrixXd matrix = root * root.transpose() + MatrixXd::Identity(size, size);
    MatrixXd factor = matrix;
    ASSERT_TRUE(factor_in_place(factor)) << size;
    const MatrixXd lower = factor.triangularView<Eigen::Lower>();
    EXPECT_LT((lower * lower.transpose() - matrix).norm(), 1e-9 * matrix.norm()) << size;
    const MatrixXd right = MatrixXd::Random(size, 3);
    MatrixXd x = right;
    solve_in_place(factor, x);
    EXPECT_LT((lower * x - right).norm(), 1e-10 * right.norm()) << size;
  }
}

TEST(SlicedProducts, WhatIsNotPositiveDefiniteHasNoFactor) {
  MatrixXd matrix = MatrixXd::Identity(40, 40);
  matrix(35, 35) = -1;
  EXPECT_FALSE(factor_in_place(matrix));
}

}  // namespace
}  // namespace waymark
