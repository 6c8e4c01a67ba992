#include "core/estimate/error_columns.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/marker/marker_outline.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

/// A camera with a lens looks at a marker from 3 m; corners are where a perfect detector sees them.
class Columns : public testing::Test {
 protected:
  Columns() {
    CameraParameters p = test::ring_rig(1).cameras[0].model.parameters();
    p.distortion = Distortion::radtan;
    p.coefficients = {-0.1, 0.05, 0.001, -0.001};
    parameters_ = p;
    observation_.size_m = 0.3;
    for (auto& w : observation_.whitening) w = Eigen::Matrix2d::Identity();
    observation_.corners_px = seen();
  }

  /// Corners as things are now.
  [[nodiscard]] ImageCorners seen() const {
    const auto model = CameraModel::create(parameters_);
    const auto x = marker_corners(observation_.size_m * size_factor_);
    ImageCorners corners;
    for (std::size_t i = 0; i < 4; ++i) {
      const Rigid3 rig = world_from_rig_.plus(
          velocity_ * (stamp_s_ + times_.after_s[i] + readout_s_ * times_.row[i]));
      corners[i] =
          *model->project(rig_from_cam_.inverse() * rig.inverse() * (world_from_marker_ * x[i]));
    }
    const auto outward = outward_of(corners);
    for (std::size_t i = 0; i < 4; ++i) corners[i] += edge_px_ * outward[i];
    return corners;
  }
  /// The columns, with what is there taken for true.
  [[nodiscard]] ErrorColumns columns() const {
    const auto model = CameraModel::create(parameters_);
    return *error_columns(observation_,
                          {&*model, rig_from_cam_.inverse(), world_from_rig_, world_from_marker_},
                          times_, velocity_);
  }
  /// How corners move where a number truly is larger than it is taken to be.
  [[nodiscard]] Vector8d moved_by(const std::function<void(double)>& change, double step) {
    const auto stacked = [&](double by) {
      change(by);
      const ImageCorners corners = seen();
      change(-by);
      Vector8d all;
      for (std::size_t i = 0; i < 4; ++i)
        all.segment<2>(2 * static_cast<Eigen::Index>(i)) = corners[i];
      return all;
    };
    return (stacked(step) - stacked(-step)) / (2 * step);
  }

  CameraParameters parameters_;
  Rigid3 rig_from_cam_{so3_exp({0.1, -0.2, 0.3}), {0.2, -0.1, 0.05}};
  Rigid3 world_from_rig_{so3_exp({0.02, 0.01, -0.03}), {0.1, 0.2, 0.3}};
  Rigid3 world_from_marker_{so3_exp({3.0, 0.3, 0.1}), {0.3, 1.2, 3.1}};
  MarkerObservation observation_;
  CornerTimes times_{{0, 0, 0, 0}, {-0.2, -0.15, 0.1, 0.12}};
  Vector6d velocity_ = (Vector6d() << 1.0, 0.2, -0.1, 0.1, 0.5, -0.3).finished();
  double size_factor_ = 1;
  double edge_px_ = 0;
  double stamp_s_ = 0;
  double readout_s_ = 0;
};

TEST_F(Columns, AreZeroErrorsWhereAllIsTrue) { EXPECT_LT(columns().residual.norm(), 1e-9); }

TEST_F(Columns, TellHowCornersMoveWithPlaces) {
  const ErrorColumns c = columns();
  for (int k = 0; k < 6; ++k) {
    const auto move = [&](Rigid3& pose) {
      return [&pose, k, base = pose, total = 0.0](double by) mutable {
        total += by;
        pose = base.plus(total * Vector6d::Unit(k));
      };
    };
    EXPECT_LT((moved_by(move(world_from_rig_), 1e-5) - c.by_pose.col(k)).norm(), 1e-2) << k;
    EXPECT_LT((moved_by(move(world_from_marker_), 1e-5) - c.by_marker.col(k)).norm(), 1e-2) << k;
    EXPECT_LT((moved_by(move(rig_from_cam_), 1e-5) - c.by_camera.col(k)).norm(), 1e-2) << k;
  }
}

TEST_F(Columns, TellHowCornersMoveWithEverythingElse) {
  const ErrorColumns c = columns();
  const auto add = [](double& number) { return [&number](double by) { number += by; }; };
  const auto focal = [&](double by) {
    const double f = by > 0 ? 1 + by : 1 / (1 - by);
    parameters_.fu_px *= f;
    parameters_.fv_px *= f;
  };
  EXPECT_LT((moved_by(focal, 1e-5) - c.by_camera.col(kFocal)).norm(), 0.05);
  EXPECT_LT((moved_by(add(parameters_.pu_px), 1e-3) - c.by_camera.col(kPrincipal)).norm(), 1e-6);
  EXPECT_LT((moved_by(add(parameters_.pv_px), 1e-3) - c.by_camera.col(kPrincipal + 1)).norm(),
            1e-6);
  EXPECT_LT((moved_by(add(parameters_.coefficients[0]), 1e-5) - c.by_camera.col(kFirstLens)).norm(),
            1e-3);
  EXPECT_LT((moved_by(add(edge_px_), 1e-3) - c.by_camera.col(kEdge)).norm(), 1e-6);
  EXPECT_LT((moved_by(add(stamp_s_), 1e-5) - c.by_camera.col(kStamp)).norm(), 0.1);
  EXPECT_LT((moved_by(add(readout_s_), 1e-5) - c.by_camera.col(kReadout)).norm(), 0.1);
  EXPECT_LT((moved_by(add(size_factor_), 1e-5) - c.by_size).norm(), 1e-2);
}

TEST_F(Columns, WhitenedHaveUnitNoise) {
  ErrorColumns c = columns();
  const Matrix86 by_pose = c.by_pose;
  c.whiten(4 * Matrix8d::Identity());
  EXPECT_LT((2 * c.by_pose - by_pose).norm(), 1e-9);
}

TEST_F(Columns, ThereAreNoneBehindTheCamera) {
  const auto model = CameraModel::create(parameters_);
  const Rigid3 turned = world_from_rig_ * Rigid3{so3_exp({0, 3.14, 0}), {0, 0, 0}};
  EXPECT_FALSE(error_columns(observation_,
                             {&*model, rig_from_cam_.inverse(), turned, world_from_marker_}, times_,
                             velocity_));
}

}  // namespace
}  // namespace waymark
