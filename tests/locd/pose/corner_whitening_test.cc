#include "locd/pose/corner_whitening.h"

#include <gtest/gtest.h>

#include "tests/support/room_map.h"

namespace waymark {
namespace {

/// One marker before the first camera of a rig that moves sideways.
class Whitened : public testing::Test {
 protected:
  static MarkerMap one_marker() {
    MarkerMap map;
    SubMap& submap = map.submaps.emplace_back();
    MapMarker& marker = submap.markers.emplace_back();
    marker.id = {Family::tag36h11, 0};
    marker.size_m = marker.stated_size_m = 0.3;
    // The first camera looks along the rig's x axis.
    marker.world_from_marker = {
        Eigen::Quaterniond(Eigen::Matrix3d{{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}), {3, 0, 0}};
    state_exact_sizes(submap);
    return map;
  }

  [[nodiscard]] std::vector<SetObservation> seen() const {
    SetObservation o;
    o.observation.size_m = 0.3;
    const auto x_in_marker = marker_corners(0.3);
    for (std::size_t i = 0; i < 4; ++i) {
      o.detected_px[i] = *solver_.model(0).project(
          solver_.cam_from_rig(0) * (map_.marker(0).world_from_marker * x_in_marker[i]));
    }
    o.stated.fill(Eigen::Matrix2d::Zero());
    o.observation.corners_px = o.detected_px;
    return {o};
  }

  /// One standard deviation of the first corner along u.
  static double sigma_px(const SetObservation& o) {
    const Eigen::Matrix2d& w = o.observation.whitening[0];
    return std::sqrt((w.transpose() * w).inverse()(0, 0));
  }

  Rig rig_ = test::ring_rig(2);
  MapIndex map_{one_marker()};
  RigPoseSolver solver_{rig_, {}};
  CornerWhitening whitening_{map_, solver_};
  KnownErrors known_{{0.1, 0.1},
                     CalibrationPrior(rig_, {}, map_.submap(), false),
                     CalibrationPrior(rig_, {}, map_.submap(), false)};
};

TEST_F(Whitened, WhatIsExactIsNoiseAlone) {
  auto o = seen();
  whitening_.whiten(o, Rigid3{}, {Vector6d::Zero(), Matrix6d::Zero()}, known_);
  EXPECT_NEAR(sigma_px(o[0]), 0.1, 1e-3);
  whitening_.whiten_roughly(o, {Vector6d::Zero(), Matrix6d::Zero()}, known_);
  EXPECT_NEAR(sigma_px(o[0]), 0.1, 1e-3);
}

TEST_F(Whitened, ACameraThatMayStandElsewhereMakesItsCornersUnsure) {
  auto o = seen();
  CalibrationVector wide = CalibrationVector::Zero();
  wide.head<3>().setConstant(0.01);
  known_.calibration.widen(0, wide);
  whitening_.whiten(o, Rigid3{}, {Vector6d::Zero(), Matrix6d::Zero()}, known_);
  // 10 mm at 3 m, counted twice in sigma for the four corners that share it.
  EXPECT_NEAR(sigma_px(o[0]), 2 * 0.01 / 3 * solver_.model(0).parameters().fu_px, 0.3);
}

TEST_F(Whitened, CornersOfAnotherInstantAreMovedByTheVelocity) {
  auto o = seen();
  o[0].after_s.fill(0.01);
  const Vector6d velocity = (Vector6d() << 0, 1, 0, 0, 0, 0).finished();
  whitening_.move_to_set_instant(o, Rigid3{}, velocity);
  const Eigen::Vector2d moved = o[0].observation.corners_px[0] - o[0].detected_px[0];
  // The rig went 10 mm to its left: before, markers were seen further left.
  EXPECT_NEAR(moved.x(), -0.01 / 3 * solver_.model(0).parameters().fu_px, 0.1);
  whitening_.move_to_set_instant(o, Rigid3{}, Vector6d::Zero());
  EXPECT_EQ(o[0].observation.corners_px[0], o[0].detected_px[0]);
}

}  // namespace
}  // namespace waymark
