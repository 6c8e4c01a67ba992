#include "locd/pose/pose_covariance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/small_map.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

constexpr double kVelocitySigma = 0.3;

/// One camera of which the instants are not known, and nothing else is in doubt.
class UnknownTimes : public testing::Test {
 protected:
  static Rig timed_rig() {
    Rig rig = test::ring_rig(1);
    rig.cameras[0].stated_sigmas = {};
    return rig;
  }

  void see(double row) {
    for (const double x_m : {-1.0, 0.0, 1.0}) {
      for (const double y_m : {-0.6, 0.6}) {
        MarkerObservation o;
        o.size_m = 0.3;
        const Rigid3 cam_from_marker{so3_exp({M_PI, 0.4 * x_m, 0}), {x_m, y_m, 4}};
        const RigCamera& cam = rig_.cameras[0];
        const auto x = marker_corners(o.size_m);
        for (std::size_t i = 0; i < 4; ++i)
          o.corners_px[i] = *cam.model.project(cam_from_marker * x[i]);
        SetObservation& seen = observations_.emplace_back();
        seen.row.fill(row);
        seen.inlier = true;
        considered_.push_back({0, 0,
                               *error_columns(o,
                                              {&cam.model, cam.rig_from_cam.inverse(), Rigid3{},
                                               cam.rig_from_cam * cam_from_marker},
                                              {}, Vector6d::Zero()),
                               ModeColumns::Zero(), true});
        considered_.back().columns.whiten(0.01 * Matrix8d::Identity());
      }
    }
    ASSERT_TRUE(
        pose_.solve(considered_, prior_, kVelocitySigma * kVelocitySigma * Matrix6d::Identity()));
  }

  Rig rig_ = timed_rig();
  CalibrationPrior prior_{rig_, {}, test::small_map().submaps[0], false};
  ConsiderPose pose_{prior_};
  std::vector<SetObservation> observations_;
  std::vector<ConsideredObservation> considered_;
};

TEST_F(UnknownTimes, MoveThePoseByWhatTheMotionIsUnsureOf) {
  see(0);
  const Matrix6d lacking = covariance_of_unknown_times(observations_, considered_, pose_, prior_);
  const double sigma_s = std::sqrt(prior_.variances_of(0)[kStamp]);
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(std::sqrt(lacking(i, i)), sigma_s * kVelocitySigma, 0.1 * sigma_s * kVelocitySigma);
  }
}

TEST_F(UnknownTimes, OfRowsGrowTowardsTheImagesEdge) {
  see(0.5);
  const Matrix6d lacking = covariance_of_unknown_times(observations_, considered_, pose_, prior_);
  const CalibrationVector v = prior_.variances_of(0);
  const double sigma_s = std::sqrt(v[kStamp] + 0.25 * v[kReadout]);
  EXPECT_NEAR(std::sqrt(lacking(3, 3)), sigma_s * kVelocitySigma, 0.1 * sigma_s * kVelocitySigma);
}

}  // namespace
}  // namespace waymark
