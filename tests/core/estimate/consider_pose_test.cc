#include "core/estimate/consider_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/symmetric_factor.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

constexpr double kNoise_px = 0.1;

/// A rig of three cameras sees eight markers with each, drawn anew; residuals are linear in all
/// errors, as ConsiderPose takes them to be.
class Considered : public testing::Test {
 protected:
  [[nodiscard]] double normal() { return normal_(random_); }

  std::vector<ConsideredObservation> see() {
    std::vector<ConsideredObservation> seen;
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
      for (int m = 0; m < 8; ++m) {
        MarkerObservation o;
        o.camera = static_cast<int>(c);
        o.size_m = 0.3;
        const Rigid3 cam_from_marker{so3_exp({M_PI, 0.4 * normal(), 0.2 * normal()}),
                                     {1.0 * normal(), 0.6 * normal(), 4 + std::abs(normal())}};
        const auto x = marker_corners(o.size_m);
        bool inside = true;
        for (std::size_t i = 0; i < 4; ++i) {
          const auto pixel = rig_.cameras[c].model.project(cam_from_marker * x[i]);
          inside = inside && pixel.has_value();
          if (pixel) o.corners_px[i] = *pixel;
        }
        if (!inside) continue;
        const auto columns =
            error_columns(o,
                          {&rig_.cameras[c].model, rig_.cameras[c].rig_from_cam.inverse(), Rigid3{},
                           rig_.cameras[c].rig_from_cam * cam_from_marker},
                          {}, Vector6d::Zero());
        seen.push_back({c, 0, *columns, ModeColumns::Zero(), true});
        seen.back().columns.whiten(kNoise_px * kNoise_px * Matrix8d::Identity());
      }
    }
    return seen;
  }

  /// Lets calibration and noise be wrong as the prior says; returns the pose's true error.
  Vector6d err(const CalibrationPrior& prior, double times,
               std::vector<ConsideredObservation>& seen) {
    Eigen::VectorXd drawn(prior.size());
    for (double& number : drawn) number = normal();
    const Eigen::MatrixXd root = prior.covariance().llt().matrixL();
    const Eigen::VectorXd e = times * root * drawn;
    Vector6d x;
    for (double& number : x) number = 1e-3 * normal();
    for (ConsideredObservation& o : seen) {
      const CalibrationVector own =
          e.segment<kCalibrationNumbers>(CalibrationPrior::first_of(o.camera));
      o.columns.residual = o.columns.by_pose * x +
                           o.columns.by_camera * CalibrationPrior::units().asDiagonal() * own +
                           o.columns.by_size * CalibrationPrior::kSizeUnit * e[prior.at_size(0)];
      for (double& number : o.columns.residual) number += normal();
    }
    return x;
  }

  /// As a careful calibration of global shutters has them.
  static Rig usual_rig() {
    Rig rig = test::ring_rig(3);
    for (RigCamera& camera : rig.cameras) {
      camera.stated_sigmas = {};
      camera.stated_sigmas.edge_px = 0.02;
      camera.global_shutter = true;
    }
    return rig;
  }
  static SubMap one_size() {
    SubMap map;
    map.markers.emplace_back().stated_size_m = 0.3;
    return map;
  }
  static SubMap exact_map() {
    SubMap map = one_size();
    state_exact_sizes(map);
    return map;
  }
  [[nodiscard]] CalibrationPrior usual_prior() const { return {rig_, {}, one_size(), false}; }

  Rig rig_ = usual_rig();
  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
};

TEST_F(Considered, ErrorsAreWhatTheCovarianceSays) {
  const CalibrationPrior prior = usual_prior();
  ConsiderPose pose(prior);
  double nees = 0, misfit = 0, freedoms = 0, outlier = 0;
  int observations = 0;
  constexpr int kTrials = 300;
  for (int t = 0; t < kTrials; ++t) {
    auto seen = see();
    const Vector6d x = err(prior, 1, seen);
    ASSERT_TRUE(pose.solve(seen, prior, Matrix6d::Identity()));
    const Vector6d error = x - pose.step();
    nees += error.dot(SymmetricFactor<6>(pose.covariance()).solve(error));
    misfit += pose.misfit();
    freedoms += pose.freedoms();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      outlier += pose.squared_sigmas(i);
      ++observations;
    }
  }
  EXPECT_NEAR(nees / kTrials, 6, 4 * std::sqrt(12.0 / kTrials));
  EXPECT_NEAR(misfit / freedoms, 1, 0.02);
  EXPECT_NEAR(outlier / observations, 8, 0.2) << "leave-one-out holds the calibration";
}

TEST_F(Considered, WhatIsExactIsLeastSquares) {
  const CalibrationPrior prior(test::ring_rig(3), {}, exact_map(), false);
  ConsiderPose pose(prior);
  auto seen = see();
  const Vector6d x = err(prior, 1, seen);
  ASSERT_TRUE(pose.solve(seen, prior, Matrix6d::Identity()));
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  for (const ConsideredObservation& o : seen) {
    information += o.columns.by_pose.transpose() * o.columns.by_pose;
    pull += o.columns.by_pose.transpose() * o.columns.residual;
  }
  const SymmetricFactor<6> factor(information);
  EXPECT_LT((factor.solve(pull) - pose.step()).norm(), 1e-6);
  EXPECT_LT((factor.inverse() - pose.covariance()).norm(), 1e-3 * factor.inverse().norm());
  EXPECT_LT((x - pose.step()).norm(), 1e-2);
}

TEST_F(Considered, AnObservationThatIsWrongShowsWhetherItIsUsedOrNot) {
  const CalibrationPrior prior = usual_prior();
  ConsiderPose pose(prior);
  auto seen = see();
  (void)err(prior, 1, seen);
  seen[3].columns.residual.array() += 60;
  ASSERT_TRUE(pose.solve(seen, prior, Matrix6d::Identity()));
  EXPECT_GT(pose.squared_sigmas(3), 36);
  seen[3].used = false;
  ASSERT_TRUE(pose.solve(seen, prior, Matrix6d::Identity()));
  EXPECT_GT(pose.squared_sigmas(3), 36);
  EXPECT_LT(pose.squared_sigmas(4), 36);
}

TEST_F(Considered, AWidenedCameraHasNoSay) {
  CalibrationPrior prior = usual_prior();
  ConsiderPose pose(prior);
  auto seen = see();
  (void)err(prior, 1, seen);
  ASSERT_TRUE(pose.solve(seen, prior, Matrix6d::Identity()));
  const double before = pose.covariance().trace();
  CalibrationVector wide = CalibrationVector::Zero();
  wide.head<6>().setConstant(1);
  prior.widen(1, wide);
  ASSERT_TRUE(pose.solve(seen, prior, Matrix6d::Identity()));
  EXPECT_GT(pose.covariance().trace(), before);
}

TEST_F(Considered, APoseWithoutSomeIsThatOfTheRest) {
  const CalibrationPrior prior = usual_prior();
  ConsiderPose pose(prior);
  auto seen = see();
  (void)err(prior, 1, seen);
  for (const std::size_t left_out : {1U, 2U}) {
    ASSERT_TRUE(pose.solve(seen, prior, Matrix6d::Identity()));
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < left_out; ++i) out.push_back(3 + i);
    const auto rest = pose.without(out);
    ASSERT_TRUE(rest.has_value());
    auto others = seen;
    for (std::size_t i = 0; i < left_out; ++i) others[3 + i].used = false;
    ASSERT_TRUE(pose.solve(others, prior, Matrix6d::Identity()));
    EXPECT_LT((rest->step - pose.step()).norm(), 1e-8) << left_out;
    EXPECT_LT((rest->covariance - pose.covariance()).norm(), 1e-6 * pose.covariance().norm());
  }
}

TEST_F(Considered, NothingIsNoPose) {
  const CalibrationPrior prior = usual_prior();
  ConsiderPose pose(prior);
  EXPECT_FALSE(pose.solve({}, prior, Matrix6d::Identity()));
}

}  // namespace
}  // namespace waymark
