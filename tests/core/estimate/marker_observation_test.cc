#include "core/estimate/marker_observation.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

MarkerObservation observation_of(const CameraModel& camera, const Rigid3& cam_from_marker) {
  MarkerObservation o;
  o.size_m = 0.3;
  const auto x = marker_corners(o.size_m);
  for (std::size_t i = 0; i < 4; ++i) o.corners_px[i] = *camera.project(cam_from_marker * x[i]);
  o.whitening.fill(2.0 * Eigen::Matrix2d::Identity());
  return o;
}

TEST(Whitening, TurnsTheCovarianceIntoTheIdentity) {
  Eigen::Matrix2d covariance;
  covariance << 0.04, -0.015, -0.015, 0.09;
  const Eigen::Matrix2d w = whitening_from_covariance(covariance);
  EXPECT_TRUE((w * covariance * w.transpose()).isApprox(Eigen::Matrix2d::Identity(), 1e-12));
}

TEST(MarkerObservation, SquaredResidualCountsSigmas) {
  const CameraModel camera = test::ring_rig(1).cameras[0].model;
  const Rigid3 pose{so3_exp({M_PI, 0.3, 0}), {0.1, 0.2, 3}};
  MarkerObservation o = observation_of(camera, pose);
  EXPECT_NEAR(squared_residual(o, camera, pose), 0, 1e-18);
  o.corners_px[2] += Eigen::Vector2d(3, 4);  // 5 px at 0.5 px per sigma: 10 sigmas
  EXPECT_NEAR(squared_residual(o, camera, pose), 100, 1e-9);
}

TEST(MarkerObservation, BehindTheCameraIsNeverAFit) {
  const CameraModel camera = test::ring_rig(1).cameras[0].model;
  const Rigid3 pose{so3_exp({M_PI, 0.3, 0}), {0.1, 0.2, 3}};
  const MarkerObservation o = observation_of(camera, pose);
  const Rigid3 behind{pose.rotation, -pose.translation};
  EXPECT_GE(squared_residual(o, camera, behind), 1e7);
  EXPECT_FALSE(corner_residuals(o, camera, behind));
}

TEST(MarkerObservation, EquationsAreTheGradientOfTheCost) {
  const Rig rig = test::ring_rig(2);
  const RigCamera& camera = rig.cameras[1];
  const Rigid3 world_from_rig{so3_exp({0.1, -0.2, 0.5}), {1, 2, 1.5}};
  const Rigid3 cam_from_marker{so3_exp({M_PI, 0.4, 0.2}), {0.2, 0.1, 2.5}};
  const Rigid3 world_from_marker = world_from_rig * camera.rig_from_cam * cam_from_marker;
  MarkerObservation o = observation_of(camera.model, cam_from_marker);
  for (std::size_t i = 0; i < 4; ++i) {
    o.corners_px[i] += Eigen::Vector2d(1.0 + 0.5 * static_cast<double>(i), -2.0);
  }
  for (const double scale : {2.0, 50.0}) {  // beyond Huber's bend, and before it
    const ObservationLoss loss{Loss::huber, scale};
    for (const FreePose free : {FreePose::rig, FreePose::marker}) {
      const auto at = [&](const Vector6d& delta) {
        PoseEquations e;
        add_observation(
            o,
            {&camera.model, camera.rig_from_cam.inverse(),
             free == FreePose::rig ? world_from_rig.plus(delta) : world_from_rig,
             free == FreePose::marker ? world_from_marker.plus(delta) : world_from_marker},
            loss, free, e);
        return e;
      };
      const auto slope = test::numeric_jacobian<1, 6>(
          [&](const Vector6d& delta) { return Eigen::Matrix<double, 1, 1>(at(delta).cost); }, 1e-5);
      const Vector6d gradient = at(Vector6d::Zero()).gradient;
      EXPECT_LT((slope.transpose() - 2 * gradient).norm(), 1e-5 * slope.norm());
    }
  }
}

TEST(ObservationLosses, AreHeldToTheirRanges) {
  expect_ranges<ObservationLoss>(
      {ranged("scale_sigmas", &ObservationLoss::scale_sigmas, ObservationLoss::kScaleSigmas)});
}

}  // namespace
}  // namespace waymark
