#include "core/estimate/pose_minimizer.h"

#include <gtest/gtest.h>

#include <limits>

namespace waymark {
namespace {

/// Six numbers, one information each: a pose that is pulled to the origin.
Matrix6d some_hessian() {
  Matrix6d root = Matrix6d::Identity();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < i; ++j) root(i, j) = 0.1 * (i - j);
  }
  return 1e4 * root * root.transpose();
}

TEST(PoseCovariance, IsTheInverseHessian) {
  for (const double size : {1e-6, 1.0, 1e12}) {
    const Matrix6d hessian = size * some_hessian();
    const auto covariance = pose_covariance(hessian);
    ASSERT_TRUE(covariance) << size;
    EXPECT_LT((*covariance * hessian - Matrix6d::Identity()).norm(), 1e-9) << size;
  }
}

TEST(PoseCovariance, WhatNothingTellsIsNotExactlyKnown) {
  EXPECT_FALSE(pose_covariance(Matrix6d::Zero()));
  for (int axis = 0; axis < 6; ++axis) {
    Matrix6d hessian = some_hessian();
    hessian.row(axis).setZero();
    hessian.col(axis).setZero();
    EXPECT_FALSE(pose_covariance(hessian)) << axis;
    hessian(axis, axis) = -1;
    EXPECT_FALSE(pose_covariance(hessian)) << axis;
    hessian(axis, axis) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(pose_covariance(hessian)) << axis;
    hessian(axis, axis) = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(pose_covariance(hessian)) << axis;
  }
}

TEST(PoseCovariance, ADirectionLeftFreeIsToldWhicheverItIs) {
  // Of five observations of one number each, all directions but one are known.
  for (int seed = 0; seed < 20; ++seed) {
    const Eigen::Matrix<double, 5, 6> jacobian = Eigen::Matrix<double, 5, 6>::Random();
    EXPECT_FALSE(pose_covariance(jacobian.transpose() * jacobian)) << seed;
  }
}

TEST(PoseCovariance, MetresAndRadiansMayDifferByMuch) {
  Matrix6d hessian = some_hessian();
  hessian.topRows<3>() *= 1e-6;
  hessian.leftCols<3>() *= 1e-6;
  EXPECT_TRUE(pose_covariance(hessian));
}

/// As every observation beyond a redescending loss is: seen, and without weight.
TEST(MinimizePose, GrossObservationsAloneLeaveACovarianceUnknown) {
  const auto optimum = minimize_pose(Rigid3(), 10, [](const Rigid3&) {
    PoseEquations equations;
    equations.corners = 8;
    equations.cost = 50;
    return equations;
  });
  ASSERT_TRUE(optimum);
  EXPECT_EQ(optimum->cost, 50);
  EXPECT_FALSE(optimum->covariance);
}

TEST(MinimizePose, AWellPosedProblemHasOne) {
  const auto optimum = minimize_pose(Rigid3(), 20, [](const Rigid3& pose) {
    PoseEquations equations;
    equations.corners = 8;
    equations.hessian = some_hessian();
    const Vector6d away = pose.minus(Rigid3());
    equations.gradient = equations.hessian * away;
    equations.cost = 0.5 * away.dot(equations.gradient);
    return equations;
  });
  ASSERT_TRUE(optimum && optimum->covariance);
  EXPECT_LT((*optimum->covariance * some_hessian() - Matrix6d::Identity()).norm(), 1e-9);
}

}  // namespace
}  // namespace waymark
