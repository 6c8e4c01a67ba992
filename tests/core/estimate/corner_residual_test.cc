#include "core/estimate/corner_residual.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/marker/marker_geometry.h"
#include "tests/support/numeric_jacobian.h"

namespace waymark {
namespace {

CameraModel camera(Distortion distortion) {
  CameraParameters p;
  p.width_px = 1280;
  p.height_px = 1024;
  p.fu_px = 470;
  p.fv_px = 473;
  p.pu_px = 640;
  p.pv_px = 512;
  p.distortion = distortion;
  if (distortion == Distortion::radtan) p.coefficients = {-0.16, 0.09, -2e-4, 3e-4};
  if (distortion == Distortion::equidistant) p.coefficients = {-0.013, -0.01, 0.012, -0.0045};
  return *CameraModel::create(p);
}

/// A rig, a camera on it and a marker in front, at random places of the world.
struct Configuration {
  CameraModel camera;
  Rigid3 cam_from_rig;
  Rigid3 world_from_rig;
  Rigid3 world_from_marker;
};

Configuration random_configuration(Distortion distortion, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&](double scale) {
    return Eigen::Vector3d(scale * normal(random), scale * normal(random), scale * normal(random));
  };
  Configuration c{
      camera(distortion), {so3_exp(vector(1)), vector(0.2)}, {so3_exp(vector(1)), vector(5)}, {}};
  const Rigid3 cam_from_marker{so3_exp(vector(0.3)), Eigen::Vector3d(0, 0, 3) + vector(0.4)};
  c.world_from_marker = c.world_from_rig * c.cam_from_rig.inverse() * cam_from_marker;
  return c;
}

class CornerResidual : public testing::TestWithParam<Distortion> {};

TEST_P(CornerResidual, IsZeroAtTruth) {
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const Configuration c = random_configuration(GetParam(), random);
    const Eigen::Vector3d x = marker_corners(0.3)[static_cast<std::size_t>(i % 4)];
    const Rigid3 cam_from_marker =
        c.cam_from_rig * c.world_from_rig.inverse() * c.world_from_marker;
    const auto pixel = c.camera.project(cam_from_marker * x);
    ASSERT_TRUE(pixel);
    const CornerChain chain(c.camera, c.cam_from_rig, c.world_from_rig, c.world_from_marker);
    const auto residual = corner_residual(chain, x, *pixel, nullptr);
    ASSERT_TRUE(residual);
    EXPECT_LT(residual->norm(), 1e-9);
  }
}

TEST_P(CornerResidual, JacobiansAgreeWithNumericDerivatives) {
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const Configuration c = random_configuration(GetParam(), random);
    const Eigen::Vector3d x = marker_corners(0.3)[static_cast<std::size_t>(i % 4)];
    const Eigen::Vector2d observed(600, 500);
    CornerJacobians jacobians;
    CalibrationJacobians calibration;
    const CornerChain chain(c.camera, c.cam_from_rig, c.world_from_rig, c.world_from_marker);
    const auto with = corner_residual(chain, x, observed, &jacobians, &calibration);
    const auto without = corner_residual(chain, x, observed, nullptr);
    ASSERT_TRUE(with && without);
    EXPECT_LT((*with - *without).norm(), 1e-9);

    const auto by_marker = test::numeric_jacobian<2, 6>([&](const Vector6d& delta) {
      const CornerChain moved(c.camera, c.cam_from_rig, c.world_from_rig,
                              c.world_from_marker.plus(delta));
      return *corner_residual(moved, x, observed, nullptr);
    });
    const auto by_rig = test::numeric_jacobian<2, 6>([&](const Vector6d& delta) {
      const CornerChain moved(c.camera, c.cam_from_rig, c.world_from_rig.plus(delta),
                              c.world_from_marker);
      return *corner_residual(moved, x, observed, nullptr);
    });
    const auto by_extrinsics = test::numeric_jacobian<2, 6>([&](const Vector6d& delta) {
      const Rigid3 rig_from_cam = c.cam_from_rig.inverse().plus(delta);
      const CornerChain moved(c.camera, rig_from_cam.inverse(), c.world_from_rig,
                              c.world_from_marker);
      return *corner_residual(moved, x, observed, nullptr);
    });
    // The camera's own derivatives are tested with the camera; here it is their sign.
    IntrinsicsJacobian of_camera;
    const Rigid3 cam_from_marker =
        c.cam_from_rig * c.world_from_rig.inverse() * c.world_from_marker;
    ASSERT_TRUE(c.camera.project_with_jacobian(cam_from_marker * x, &of_camera));
    const double scale = by_rig.norm();
    EXPECT_LT((calibration.d_extrinsics - by_extrinsics).norm(), 1e-7 * scale);
    EXPECT_LT((calibration.d_intrinsics + of_camera).norm(), 1e-9 * scale);
    EXPECT_LT((jacobians.d_marker - by_marker).norm(), 1e-7 * scale);
    EXPECT_LT((jacobians.d_rig - by_rig).norm(), 1e-7 * scale);
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, CornerResidual,
                         testing::Values(Distortion::none, Distortion::radtan,
                                         Distortion::equidistant),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST(CornerResidualDomain, ACornerBehindThePinholeHasNoResidual) {
  const CameraModel pinhole = camera(Distortion::none);
  CornerJacobians jacobians;
  const Rigid3 behind{Eigen::Quaterniond::Identity(), {0, 0, -2}};
  const CornerChain chain(pinhole, {}, {}, behind);
  EXPECT_FALSE(corner_residual(chain, {0, 0, 0}, {640, 512}, nullptr));
  EXPECT_FALSE(corner_residual(chain, {0, 0, 0}, {640, 512}, &jacobians));
}

}  // namespace
}  // namespace waymark
