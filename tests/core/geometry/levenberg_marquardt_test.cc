#include "core/geometry/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace waymark {
namespace {

/// Distances of a point from four others, one of which is off; its cost has a curved valley.
NormalEquations<3> distances(const Eigen::Vector3d& x) {
  const std::array<Eigen::Vector3d, 4> anchors{{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {1, 1, 5}}};
  const Eigen::Vector3d truth(1, 2, 0.5);
  NormalEquations<3> equations;
  for (const Eigen::Vector3d& anchor : anchors) {
    const double distance = (x - anchor).norm();
    const double residual = distance - (truth - anchor).norm();
    const Eigen::Vector3d j = (x - anchor) / distance;
    equations.hessian += j * j.transpose();
    equations.gradient += j * residual;
    equations.cost += residual * residual;
    ++equations.corners;
  }
  return equations;
}

Eigen::Vector3d moved(const Eigen::Vector3d& from, const Eigen::Vector3d& step) {
  return from + step;
}

TEST(LevenbergMarquardt, EndsAtTheOptimumFromFarAway) {
  for (const Eigen::Vector3d& start :
       {Eigen::Vector3d(1.1, 2.1, 0.4), Eigen::Vector3d(20, -30, 40)}) {
    const auto optimum =
        minimize<3>(start, {.max_iterations = 100, .negligible_decrease = 1e-18}, distances, moved);
    ASSERT_TRUE(optimum);
    EXPECT_LT((optimum->place - Eigen::Vector3d(1, 2, 0.5)).norm(), 1e-6);
    EXPECT_LT(optimum->equations.cost, 1e-12);
  }
}

TEST(LevenbergMarquardt, StepsThatRaiseTheCostAreTakenBack) {
  // Newton's step of √(1 + x²), from far away, leads much farther away.
  const auto valley = [](const Eigen::Vector3d& x) {
    NormalEquations<3> equations;
    const double root = std::sqrt(1 + x.squaredNorm());
    equations.hessian = Eigen::Matrix3d::Identity() / (root * root * root);
    equations.gradient = x / root;
    equations.cost = root;
    equations.corners = 4;
    return equations;
  };
  double before = valley(Eigen::Vector3d(3, 0, 0)).cost;
  for (int iterations = 0; iterations < 40; ++iterations) {
    const auto reached =
        minimize<3>(Eigen::Vector3d(3, 0, 0), {.max_iterations = iterations}, valley, moved);
    ASSERT_TRUE(reached);
    EXPECT_LE(reached->equations.cost, before);
    before = reached->equations.cost;
  }
  EXPECT_LT(before, 1 + 1e-6);
}

TEST(LevenbergMarquardt, WhatCanHardlyBeSeenHasNoOptimum) {
  const auto with_corners = [](int corners) {
    return minimize<3>(
        Eigen::Vector3d(1, 1, 1), {},
        [corners](const Eigen::Vector3d&) {
          NormalEquations<3> equations;
          equations.corners = corners;
          return equations;
        },
        moved);
  };
  EXPECT_FALSE(with_corners(2));
  EXPECT_TRUE(with_corners(3));
}

}  // namespace
}  // namespace waymark
