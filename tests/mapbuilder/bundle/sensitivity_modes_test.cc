#include "mapbuilder/bundle/sensitivity_modes.h"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd made(rows, columns);
  for (double& one : made.reshaped()) one = normal(random);
  return made;
}

TEST(SensitivityModes, AreNoMoreThanTheRank) {
  // Three directions of twenty hold all.
  const Eigen::MatrixXd low = random_matrix(60, 3, 1) * random_matrix(3, 20, 2) / 20;
  const SensitivityModes modes = sensitivity_modes(low, 16);
  EXPECT_LE(modes.directions.cols(), 3);
  EXPECT_LE(modes.dropped_mean, kDroppedMean);
  EXPECT_TRUE((modes.directions.transpose() * modes.directions).isIdentity(1e-12));
}

TEST(SensitivityModes, NoneWhereNothingIsConsidered) {
  EXPECT_EQ(sensitivity_modes(1e-9 * random_matrix(60, 20, 1), 16).directions.cols(), 0);
}

TEST(SensitivityModes, SayWhatMoreWouldHold) {
  const Eigen::MatrixXd full = random_matrix(240, 40, 3) / std::sqrt(40.0);
  const SensitivityModes modes = sensitivity_modes(full, 16);
  EXPECT_EQ(modes.directions.cols(), 16);
  EXPECT_GT(modes.dropped_mean, kDroppedMean);
  // What is dropped is what is said.
  const Eigen::MatrixXd left = full - full * modes.directions * modes.directions.transpose();
  EXPECT_NEAR(modes.dropped_mean, left.squaredNorm() / 240, 1e-12);
}

TEST(SensitivityModes, LeadingColumnsLieWithinTheCovariance) {
  const Eigen::MatrixXd root =
      random_matrix(24, 24, 4) * Eigen::VectorXd::LinSpaced(24, 3, 0.01).asDiagonal();
  const Eigen::MatrixXd g = root * root.transpose();
  const CovarianceTimes times = [&](const Eigen::MatrixXd& x) { return Eigen::MatrixXd(g * x); };
  std::vector<Matrix6d> roots;
  for (Eigen::Index i = 0; i < 4; ++i) {
    roots.push_back(inverse_root(Matrix6d(g.block<6, 6>(6 * i, 6 * i))));
    EXPECT_TRUE(
        (roots.back() * g.block<6, 6>(6 * i, 6 * i) * roots.back().transpose()).isIdentity(1e-9));
  }
  const Eigen::MatrixXd columns = leading_columns(times, roots, 8);
  const Eigen::MatrixXd left = g - columns * columns.transpose();
  EXPECT_GT(symmetric_eigen<Eigen::Dynamic>(left).values[0], -1e-9 * g.trace());
  EXPECT_LT(left.trace(), 0.6 * g.trace());
}

TEST(SensitivityModes, AShortMapHasNoMoreColumnsThanRows) {
  const Eigen::MatrixXd g = Eigen::MatrixXd::Identity(6, 6);
  const Eigen::MatrixXd columns = leading_columns(
      [&](const Eigen::MatrixXd& x) { return Eigen::MatrixXd(g * x); }, {Matrix6d::Identity()}, 16);
  EXPECT_EQ(columns.cols(), 16);
  EXPECT_TRUE((columns * columns.transpose()).isApprox(g, 1e-9));
}

}  // namespace
}  // namespace waymark
