#include "core/estimate/ippe.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

CameraModel pinhole() {
  CameraParameters p;
  p.width_px = 1280;
  p.height_px = 1024;
  p.fu_px = 900;
  p.fv_px = 905;
  p.pu_px = 640;
  p.pv_px = 512;
  return *CameraModel::create(p);
}

CameraModel fisheye() {
  CameraParameters p = pinhole().parameters();
  p.fu_px = p.fv_px = 300;
  p.distortion = Distortion::equidistant;
  p.coefficients = {0.01, -0.002, 0.0005, 0};
  return *CameraModel::create(p);
}

/// A marker seen from its front, tilted by up to `tilt_rad` from facing the camera in `direction`.
Rigid3 facing(const Eigen::Vector3d& direction, double distance_m, double tilt_rad,
              std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const Eigen::Quaterniond towards =
      shortest_rotation(Eigen::Vector3d::UnitZ(), -direction.normalized());
  const Eigen::Vector3d axis(unit(random), unit(random), 0);
  const Eigen::Quaterniond tilt = so3_exp(tilt_rad * axis.normalized());
  const Eigen::Quaterniond roll = so3_exp({0, 0, 3 * unit(random)});
  return {towards * tilt * roll, distance_m * direction.normalized()};
}

ImageCorners project(const CameraModel& camera, const Rigid3& cam_from_marker, double size_m) {
  ImageCorners corners;
  const auto x = marker_corners(size_m);
  for (std::size_t i = 0; i < 4; ++i) corners[i] = *camera.project(cam_from_marker * x[i]);
  return corners;
}

TEST(Ippe, OneSolutionIsTheTruthForExactCorners) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Rigid3 truth =
        facing({0.4 * unit(random), 0.3 * unit(random), 1}, 2.0 + unit(random), 0.9, random);
    const auto solutions = solve_ippe(pinhole(), project(pinhole(), truth, 0.2), 0.2);
    ASSERT_TRUE(solutions);
    EXPECT_LT(solutions->rms_px[0], 1e-6);
    EXPECT_LE(solutions->rms_px[0], solutions->rms_px[1]);
    EXPECT_LT(angle_between_rad(solutions->cam_from_marker[0].rotation, truth.rotation), 1e-7);
    EXPECT_LT((solutions->cam_from_marker[0].translation - truth.translation).norm(), 1e-7);
  }
}

TEST(Ippe, AFrontalMarkersFlipIsTheSecondSolution) {
  // Far and tilted a little: mirrored at the viewing ray, nearly as good.
  std::mt19937 random(6);
  const Rigid3 truth = facing({0, 0, 1}, 6.0, 0.25, random);
  const auto solutions = solve_ippe(pinhole(), project(pinhole(), truth, 0.2), 0.2);
  ASSERT_TRUE(solutions);
  EXPECT_LT(solutions->rms_px[1], 0.5);
  EXPECT_NEAR(angle_between_rad(solutions->cam_from_marker[0].rotation,
                                solutions->cam_from_marker[1].rotation),
              0.5, 0.05);
}

TEST(Ippe, WorksBeyondNinetyDegreesOfAFisheye) {
  std::mt19937 random(7);
  const Eigen::Vector3d sideways_and_back(1, 0.1, -0.12);
  const Rigid3 truth = facing(sideways_and_back, 1.5, 0.5, random);
  ASSERT_LT(truth.translation.z(), 0);
  const auto solutions = solve_ippe(fisheye(), project(fisheye(), truth, 0.2), 0.2);
  ASSERT_TRUE(solutions);
  EXPECT_LT(angle_between_rad(solutions->cam_from_marker[0].rotation, truth.rotation), 1e-6);
}

TEST(Ippe, AgreesWithOpenCvOnNoisyCorners) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> noise(0, 0.3);
  const CameraParameters p = pinhole().parameters();
  const cv::Matx33d k(p.fu_px, 0, p.pu_px, 0, p.fv_px, p.pv_px, 0, 0, 1);
  const double size_m = 0.2;
  for (int i = 0; i < 50; ++i) {
    const Rigid3 truth = facing({0.3 * unit(random), 0.2 * unit(random), 1}, 2.0, 0.8, random);
    ImageCorners corners = project(pinhole(), truth, size_m);
    std::vector<cv::Point2d> image;
    for (Eigen::Vector2d& c : corners) {
      c += Eigen::Vector2d(noise(random), noise(random));
      image.emplace_back(c.x(), c.y());
    }
    std::vector<cv::Point3d> object;
    for (const Eigen::Vector3d& x : marker_corners(size_m))
      object.emplace_back(x.x(), x.y(), x.z());
    std::vector<cv::Mat> turns;
    std::vector<cv::Mat> shifts;
    cv::solvePnPGeneric(object, image, k, cv::noArray(), turns, shifts, false,
                        cv::SOLVEPNP_IPPE_SQUARE);
    ASSERT_EQ(turns.size(), 2U);
    const auto solutions = solve_ippe(pinhole(), corners, size_m);
    ASSERT_TRUE(solutions);
    for (std::size_t s = 0; s < 2; ++s) {
      const auto turn = turns[s].ptr<double>();
      const auto shift = shifts[s].ptr<double>();
      const Eigen::Quaterniond opencv = so3_exp({turn[0], turn[1], turn[2]});
      // The two linearize about different points (virtual camera here), so noise parts them a
      // little.
      EXPECT_LT(angle_between_rad(solutions->cam_from_marker[s].rotation, opencv), 0.03);
      EXPECT_LT((solutions->cam_from_marker[s].translation -
                 Eigen::Vector3d(shift[0], shift[1], shift[2]))
                    .norm(),
                0.02);
    }
  }
}

TEST(Ippe, RefusesWhatIsNoFrontViewOfASquare) {
  const CameraModel camera = pinhole();
  const ImageCorners front{{{600, 500}, {700, 500}, {700, 600}, {600, 600}}};
  EXPECT_TRUE(solve_ippe(camera, front, 0.2));
  const ImageCorners from_behind{{front[1], front[0], front[3], front[2]}};
  EXPECT_FALSE(solve_ippe(camera, from_behind, 0.2));
  const ImageCorners line{{{600, 500}, {650, 500}, {700, 500}, {750, 500}}};
  EXPECT_FALSE(solve_ippe(camera, line, 0.2));
  const ImageCorners point{{front[0], front[0], front[0], front[0]}};
  EXPECT_FALSE(solve_ippe(camera, point, 0.2));
}

}  // namespace
}  // namespace waymark
