#include "mapbuilder/upkeep/marker_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace waymark {
namespace {

/// A chain of markers, each with its neighbours, and the first with the last but one.
MarkerSystem some_system(int markers) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  MarkerSystem system;
  system.world_from_marker.resize(static_cast<std::size_t>(markers));
  for (int i = 0; i < markers; ++i) system.blocks[{i, i}] = 1e-3 * Matrix6d::Identity();
  const auto tie = [&](int i, int j) {
    Eigen::Matrix<double, 6, 12> jacobian;
    for (double& value : jacobian.reshaped()) value = normal(random);
    system.blocks[{i, i}] += jacobian.leftCols<6>().transpose() * jacobian.leftCols<6>();
    system.blocks[{j, j}] += jacobian.rightCols<6>().transpose() * jacobian.rightCols<6>();
    auto& block = system.blocks.try_emplace({j, i}, Matrix6d::Zero()).first->second;
    block += jacobian.rightCols<6>().transpose() * jacobian.leftCols<6>();
  };
  for (int i = 0; i + 1 < markers; ++i) tie(i, i + 1);
  tie(0, markers - 2);
  return system;
}

Eigen::MatrixXd dense(const MarkerSystem& system) {
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(6 * system.markers(), 6 * system.markers());
  for (const auto& [at, block] : system.blocks) {
    full.block<6, 6>(6 * at.first, 6 * at.second) = block;
    full.block<6, 6>(6 * at.second, 6 * at.first) = block.transpose();
  }
  return full;
}

TEST(MarkerSystem, AMarginalHasTheCovariancesOfTheWhole) {
  const MarkerSystem system = some_system(6);
  const std::vector<int> kept{0, 2, 5};
  const MarkerSystem marginal = marginal_system(system, kept);
  ASSERT_EQ(marginal.markers(), 3);
  const Eigen::MatrixXd whole = dense(system).inverse();
  const Eigen::MatrixXd part = dense(marginal).inverse();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const Matrix6d expected = whole.block<6, 6>(6 * kept[static_cast<std::size_t>(a)],
                                                  6 * kept[static_cast<std::size_t>(b)]);
      EXPECT_LT((part.block<6, 6>(6 * a, 6 * b) - expected).norm(), 1e-6 * whole.norm());
    }
  }
}

TEST(MarkerSystem, WhatIsNotDeterminedTellsNothing) {
  MarkerSystem system = some_system(4);
  system.blocks.erase({3, 2});
  system.blocks[{3, 3}].setZero();
  EXPECT_EQ(marginal_system(system, {0, 1, 2}).markers(), 3);
}

TEST(MarkerSystem, IsACholeskyFactorsMatrix) {
  const MarkerSystem system = some_system(5);
  const BlockMatrix matrix = block_matrix_of(system);
  EXPECT_EQ(matrix.pattern.columns(), 5);
  EXPECT_EQ(matrix.blocks.size(), system.blocks.size());
  for (const auto& [at, block] : system.blocks) {
    const int found = matrix.pattern.find(at.first, at.second);
    ASSERT_GE(found, 0);
    EXPECT_EQ(matrix.blocks[static_cast<std::size_t>(found)], block);
  }
  for (int column = 0; column < 5; ++column) {
    const int first = matrix.pattern.first[static_cast<std::size_t>(column)];
    EXPECT_EQ(matrix.pattern.rows[static_cast<std::size_t>(first)], column);
  }
}

SubMap one_marker(const Matrix6d& covariance) {
  SubMap submap;
  submap.markers.resize(1);
  submap.markers[0].covariance = covariance;
  return submap;
}

TEST(MarkerSystem, OfIndependentMarkersIsTheInverseOfTheirCovariances) {
  Matrix6d root = 1e-3 * Matrix6d::Identity();
  root(3, 1) = 2e-4;
  const Matrix6d covariance = root * root.transpose();
  const Matrix6d information = independent_system(one_marker(covariance)).blocks.at({0, 0});
  EXPECT_LT((information * covariance - Matrix6d::Identity()).norm(), 1e-9);
}

TEST(MarkerSystem, NothingIsKnownBetterThanPaperHangs) {
  for (const double sigma : {0.0, 0.9e-5, 1.1e-5}) {
    const Matrix6d covariance = sigma * sigma * Matrix6d::Identity();
    const Matrix6d information = independent_system(one_marker(covariance)).blocks.at({0, 0});
    EXPECT_NEAR(1 / std::sqrt(information(0, 0)), std::max(sigma, 1e-5), 1e-9);
  }
}

TEST(MarkerSystem, AnUnknownCovarianceIsADecimetre) {
  const Matrix6d information =
      independent_system(one_marker(unknown_covariance())).blocks.at({0, 0});
  EXPECT_NEAR(information(2, 2), 100, 1e-9);
}

}  // namespace
}  // namespace waymark
