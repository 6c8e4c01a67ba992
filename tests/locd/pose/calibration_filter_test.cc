#include "locd/pose/calibration_filter.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "tests/support/small_map.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

/// Blocks of evidence of a rig of two cameras that drives among three markers, its calibration
/// wrong by what is given.
class Learnt : public testing::Test {
 protected:
  static MarkerMap map_of(double own_sigma_m) {
    MarkerMap map = test::small_map();
    for (MapMarker& marker : map.submaps[0].markers) {
      marker.covariance = own_sigma_m * own_sigma_m * Matrix6d::Identity();
    }
    return map;
  }

  [[nodiscard]] double normal() { return normal_(random_); }

  [[nodiscard]] EvidenceRow row(std::size_t marker, std::size_t camera) {
    MarkerObservation o;
    o.size_m = 0.3;
    const Rigid3 cam_from_marker{so3_exp({M_PI, 0.4 * normal(), 0}),
                                 {normal(), 0.6 * normal(), 5 + normal() / 2}};
    const auto x = marker_corners(o.size_m);
    const RigCamera& cam = rig_.cameras[camera];
    for (std::size_t i = 0; i < 4; ++i)
      o.corners_px[i] = *cam.model.project(cam_from_marker * x[i]);
    EvidenceRow row{marker, camera, 0,
                    *error_columns(o,
                                   {&cam.model, cam.rig_from_cam.inverse(), Rigid3{},
                                    cam.rig_from_cam * cam_from_marker},
                                   {}, Vector6d::Constant(0.3))};
    row.columns.whiten(0.01 * Matrix8d::Identity());
    for (double& number : row.columns.residual) number = normal();
    return row;
  }

  /// A block of eight sets, seen by what cameras truly err by; and markers, each by its own.
  [[nodiscard]] const Evidence::System& block(const std::vector<CalibrationVector>& errors,
                                              const std::vector<Vector6d>& of_markers) {
    for (int set = 0; set < Evidence::kSetsPerBlock; ++set) {
      const Vector6d pose = 1e-3 * Vector6d::NullaryExpr([&] { return normal(); });
      std::vector<EvidenceRow> rows;
      for (std::size_t camera = 0; camera < 2; ++camera) {
        for (std::size_t marker = 0; marker < 3; ++marker) {
          EvidenceRow& r = rows.emplace_back(row(marker, camera));
          ErrorColumns& c = r.columns;
          c.residual += c.by_pose * pose + c.by_camera * errors[camera];
          if (!of_markers.empty()) c.residual += c.by_marker * of_markers[marker];
        }
      }
      evidence_.add(Rigid3(), rows);
    }
    evidence_.block(0, system_);
    return system_;
  }

  /// As the prior says, but for edges: the filter's own subject.
  [[nodiscard]] std::vector<CalibrationVector> draw() {
    std::vector<CalibrationVector> errors(2);
    for (std::size_t c = 0; c < 2; ++c) {
      const CalibrationVector sigmas = prior_.variances_of(c).cwiseSqrt();
      for (Eigen::Index i = 0; i < kCalibrationNumbers; ++i) errors[c][i] = sigmas[i] * normal();
    }
    return errors;
  }

  static Rig usual_rig() {
    Rig rig = test::ring_rig(2);
    for (RigCamera& camera : rig.cameras) {
      camera.stated_sigmas = {};
      camera.global_shutter = true;
    }
    return rig;
  }

  Rig rig_ = usual_rig();
  MapIndex map_{map_of(0)};
  CalibrationPrior prior_{rig_, {}, map_.submap(), false};
  Evidence evidence_{prior_};
  Evidence::System system_;
  std::mt19937 random_{4};
  std::normal_distribution<double> normal_;
};

TEST_F(Learnt, CalibrationsAreAsWrongAsTheirCovarianceSaysAndBetterThanStated) {
  constexpr int kTrials = 30;
  constexpr int kBlocks = 20;
  const Eigen::Index numbers = CalibrationPrior::first_of(2);
  double squared = 0;
  double stated = 0;
  double left = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    CalibrationFilter filter(prior_, map_);
    const auto errors = draw();
    for (int b = 0; b < kBlocks; ++b) {
      EXPECT_TRUE(filter.take(block(errors, {}), std::chrono::seconds(b)));
    }
    ASSERT_EQ(filter.blocks(), kBlocks);
    const CalibrationPrior& known = filter.known();
    Eigen::VectorXd error = known.mean().head(numbers);
    for (std::size_t c = 0; c < 2; ++c) {
      error.segment<kCalibrationNumbers>(CalibrationPrior::first_of(c)) -=
          errors[c].cwiseQuotient(CalibrationPrior::units());
    }
    const Eigen::MatrixXd covariance = known.covariance().topLeftCorner(numbers, numbers);
    squared += error.dot(covariance.ldlt().solve(error));
    stated +=
        prior_.covariance().diagonal().segment(CalibrationPrior::first_of(1) + kFocal, 1).sum();
    left += covariance.diagonal().segment(CalibrationPrior::first_of(1) + kFocal, 1).sum();
  }
  const double freedoms = static_cast<double>(numbers) * kTrials;
  EXPECT_NEAR(squared / freedoms, 1, 5 * std::sqrt(2 / freedoms));
  EXPECT_LT(left, 0.1 * stated) << "the focal length, which no other number can stand for";
}

TEST_F(Learnt, TheMapIsNoneOfIt) {
  CalibrationFilter filter(prior_, map_);
  EXPECT_TRUE(filter.take(block(draw(), {}), Stamp{0}));
  const Eigen::Index rest = prior_.size() - CalibrationPrior::first_of(2);
  EXPECT_EQ(filter.known().mean().tail(rest).norm(), 0) << "sizes and modes are considered";
}

TEST_F(Learnt, MarkersOwnErrorsSeenAgainAreNoNewTruth) {
  const MapIndex by_hand(map_of(0.005));
  CalibrationFilter filter(prior_, by_hand);
  std::vector<Vector6d> of_markers(3);
  for (Vector6d& one : of_markers) one = 0.005 * Vector6d::NullaryExpr([&] { return normal(); });
  const std::vector<CalibrationVector> none(2, CalibrationVector::Zero());
  for (int b = 0; b < 40; ++b) {
    static_cast<void>(filter.take(block(none, of_markers), std::chrono::seconds(b)));
  }
  const CalibrationPrior& known = filter.known();
  for (Eigen::Index i = 0; i < CalibrationPrior::first_of(2); ++i) {
    EXPECT_LT(std::abs(known.mean()[i]), 4 * std::sqrt(known.covariance()(i, i))) << i;
  }
}

TEST_F(Learnt, WhatNoCalibrationErrsByIsNotTaken) {
  CalibrationFilter filter(prior_, map_);
  std::vector<CalibrationVector> errors(2, CalibrationVector::Zero());
  EXPECT_TRUE(filter.take(block(errors, {}), Stamp{0}));
  const Eigen::VectorXd before = filter.known().mean();
  errors[1][4] = 0.02;  // rad: knocked
  EXPECT_FALSE(filter.take(block(errors, {}), Stamp{0}));
  EXPECT_EQ(filter.known().mean(), before);
  EXPECT_EQ(filter.blocks(), 1);
}

TEST_F(Learnt, BeyondThreeStatedSigmasItIsAsStated) {
  std::vector<CalibrationVector> errors(2, CalibrationVector::Zero());
  const double sigma = std::sqrt(prior_.variances_of(1)[kFocal]);
  for (const double sigmas : {2.5, 3.5}) {
    CalibrationFilter filter(prior_, map_);
    errors[1][kFocal] = sigmas * sigma;
    for (int b = 0; b < 6; ++b) static_cast<void>(filter.take(block(errors, {}), Stamp{0}));
    EXPECT_EQ(filter.known().mean().isZero(), sigmas > 3) << sigmas;
  }
}

TEST_F(Learnt, ItIsForgottenWhenToldAndSlowlyOfItself) {
  CalibrationFilter filter(prior_, map_);
  const std::vector<CalibrationVector> none(2, CalibrationVector::Zero());
  EXPECT_TRUE(filter.take(block(none, {}), Stamp{0}));
  const Eigen::Index at = CalibrationPrior::first_of(1) + 4;
  const double soon = filter.known().covariance()(at, at);
  EXPECT_TRUE(filter.take(block(none, {}), std::chrono::hours(1000)));
  EXPECT_GT(filter.known().covariance()(at, at), 0.9 * soon) << "as if it were the first block";
  EXPECT_LE(filter.known().covariance()(at, at), prior_.covariance()(at, at));
  filter.reset();
  EXPECT_EQ(filter.known().covariance(), prior_.covariance());
  EXPECT_TRUE(filter.known().mean().isZero());
}

}  // namespace
}  // namespace waymark
