#include "core/camera/camera_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/geometry/decompositions.h"
#include "tests/support/numeric_jacobian.h"

namespace waymark {
namespace {

struct Lens {
  const char* name;
  CameraParameters parameters;
};

void PrintTo(const Lens& lens, std::ostream* out) { *out << lens.name; }

constexpr auto kNone = Distortion::none;
constexpr auto kRadtan = Distortion::radtan;
constexpr auto kFisheye = Distortion::equidistant;

/// Lenses of real rigs, and of the extremes between which lenses lie.
const Lens kLenses[] = {
    {"pinhole", {1224, 1024, 1702.0, 1702.0, 611.5, 511.5, kNone, {}}},
    {"hand_camera",
     {2048,
      2048,
      1502.3643772338376,
      1500.5878284249407,
      1025.6942606592718,
      1030.4834154577413,
      kRadtan,
      {-0.16362577331649863, 0.09153792940542683, -0.00018620069216787472,
       -0.0002030253527345204}}},
    {"phone", {2016, 1512, 1661.05, 1661.05, 998.25, 762.35, kRadtan, {0.0407, -0.0236, 0.0, 0.0}}},
    {"undistorted_radtan", {1920, 1080, 1366.43, 1365.85, 961.648, 533.627, kRadtan, {}}},
    {"drone",
     {752,
      480,
      458.654,
      457.296,
      367.215,
      248.375,
      kRadtan,
      {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}}},
    {"pincushion_tangential",
     {1280, 1024, 900.0, 905.0, 640.0, 500.0, kRadtan, {0.12, 0.03, 0.004, -0.006}}},
    {"fisheye_0",
     {1280,
      1024,
      470.338,
      470.521,
      639.698,
      524.42,
      kFisheye,
      {-0.013211, -0.00988947, 0.0121051, -0.00452971}}},
    {"fisheye_1",
     {1280,
      1024,
      467.815,
      467.971,
      641.13,
      511.084,
      kFisheye,
      {-0.0144969, -0.00155277, 0.00396197, -0.00200986}}},
    {"fisheye_2",
     {1280,
      1024,
      472.938,
      472.862,
      638.667,
      514.481,
      kFisheye,
      {0.000221074, -0.0302259, 0.0280996, -0.00926951}}},
    {"fisheye_3",
     {1280,
      1024,
      471.777,
      471.863,
      629.462,
      515.161,
      kFisheye,
      {-0.0188628, 0.00123258, 0.00485599, -0.00313224}}},
    {"fisheye_220_degrees", {1000, 1000, 260.0, 260.0, 500.0, 500.0, kFisheye, {}}},
    // OpenCV's of a webcam: its sample's left camera.
    {"webcam_k3",
     {640,
      480,
      535.4,
      535.4,
      342.2,
      235.6,
      Distortion::radtan5,
      {-0.266425, -0.037841, 0.001784, -0.000284, 0.238187}}},
    {"rational_120_degrees",
     {1280,
      960,
      602.1,
      601.7,
      638.2,
      482.9,
      Distortion::rational,
      {7.62, 4.42, 4.6e-5, 1.2e-4, 0.202, 7.95, 6.75, 1.21}}},
    {"eucm_190_degrees", {1000, 1000, 301.0, 300.0, 500.5, 498.0, Distortion::eucm, {0.61, 1.08}}},
    {"eucm_narrow", {752, 480, 460.0, 459.0, 360.0, 250.0, Distortion::eucm, {0.4, 0.9}}},
    {"ds_190_degrees",
     {1000, 1000, 242.0, 241.0, 500.5, 498.0, Distortion::double_sphere, {-0.19, 0.58}}},
    {"ds_narrow", {752, 480, 470.0, 468.0, 360.0, 250.0, Distortion::double_sphere, {0.1, 0.4}}},
    {"ds_nearly_straight",
     {752, 480, 470.0, 468.0, 360.0, 250.0, Distortion::double_sphere, {0, 0.01}}},
};

CameraModel model_of(const CameraParameters& parameters) {
  auto model = CameraModel::create(parameters);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return *std::move(model);
}

/// Distance from the axis (in focal lengths) at which a lens's radius stops growing.
double image_radius(const CameraParameters& p) {
  if (p.distortion == Distortion::eucm && p.coefficients[0] > 0.5) {
    return 1 / std::sqrt(p.coefficients[1] * (2 * p.coefficients[0] - 1));
  }
  if (p.distortion == Distortion::double_sphere && p.coefficients[1] > 0.5) {
    return 1 / std::sqrt(2 * p.coefficients[1] - 1);
  }
  if (p.distortion != kFisheye) return std::numeric_limits<double>::infinity();
  const auto& k = p.coefficients;
  double radius = 0;
  for (double t = 0; t < std::numbers::pi; t += 1e-4) {
    const double next = t + k[0] * std::pow(t, 3) + k[1] * std::pow(t, 5) + k[2] * std::pow(t, 7) +
                        k[3] * std::pow(t, 9);
    if (next < radius) break;
    radius = next;
  }
  return radius;
}

class CameraModelOfLens : public ::testing::TestWithParam<Lens> {
 protected:
  /// Whether the lens can image anything there: fisheyes leave the corners of their images black.
  [[nodiscard]] bool within_lens(const Eigen::Vector2d& pixel) const {
    const CameraParameters& p = GetParam().parameters;
    return std::hypot((pixel.x() - p.pu_px) / p.fu_px, (pixel.y() - p.pv_px) / p.fv_px) <
           lens_radius_ - 1e-4;
  }

  /// Seeded random pixels of the image.
  std::vector<Eigen::Vector2d> random_pixels(int count) {
    const CameraParameters& p = GetParam().parameters;
    std::uniform_real_distribution<double> x(-0.5, p.width_px - 0.5);
    std::uniform_real_distribution<double> y(-0.5, p.height_px - 0.5);
    std::vector<Eigen::Vector2d> pixels;
    while (std::ssize(pixels) < count) {
      const Eigen::Vector2d pixel(x(random_), y(random_));
      if (within_lens(pixel)) pixels.push_back(pixel);
    }
    return pixels;
  }

  const CameraModel model_ = model_of(GetParam().parameters);
  const double lens_radius_ = image_radius(GetParam().parameters);
  std::mt19937 random_{5};
};

INSTANTIATE_TEST_SUITE_P(Lenses, CameraModelOfLens, ::testing::ValuesIn(kLenses),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(CameraModelOfLens, EveryPixelOfTheImageComesBack) {
  const CameraParameters& p = GetParam().parameters;
  for (double v = -0.5; v <= p.height_px - 0.5; v += p.height_px / 64.0) {
    for (double u = -0.5; u <= p.width_px - 0.5; u += p.width_px / 64.0) {
      const Eigen::Vector2d pixel(u, v);
      const auto bearing = model_.bearing(pixel);
      if (!within_lens(pixel)) continue;
      ASSERT_TRUE(bearing) << pixel.transpose();
      ASSERT_NEAR(bearing->norm(), 1, 1e-14);
      const auto back = model_.project(3.7 * *bearing);
      ASSERT_TRUE(back) << pixel.transpose();
      ASSERT_LT((*back - pixel).norm(), 1e-9) << pixel.transpose();
    }
  }
}

TEST_P(CameraModelOfLens, EveryBearingComesBack) {
  for (const Eigen::Vector2d& pixel : random_pixels(500)) {
    const auto bearing = model_.bearing(pixel);
    ASSERT_TRUE(bearing);
    const auto again = model_.bearing(*model_.project(*bearing));
    ASSERT_TRUE(again);
    // Where the lens hardly resolves angles any more, a pixel's last digit is more than 1e-12 rad.
    const auto by_point = model_.project_with_jacobian(*bearing)->d_pixel_d_point;
    const double px_per_rad =
        std::sqrt(symmetric_eigenvalues<3>(by_point.transpose() * by_point)[1]);
    ASSERT_LT((*again - *bearing).norm(), 1e-12 * std::max(1.0, 100 / px_per_rad));
  }
}

TEST_P(CameraModelOfLens, JacobianByPointMatchesNumericDerivative) {
  for (const Eigen::Vector2d& pixel : random_pixels(200)) {
    const Eigen::Vector3d point = 5 * *model_.bearing(pixel);
    const auto projection = model_.project_with_jacobian(point);
    ASSERT_TRUE(projection);
    EXPECT_EQ(projection->pixel, *model_.project(point));
    const auto numeric = test::numeric_jacobian<2, 3>(
        [&](const Eigen::Vector3d& delta) { return *model_.project(point + delta); });
    ASSERT_LT((projection->d_pixel_d_point - numeric).cwiseAbs().maxCoeff(),
              1e-7 * projection->d_pixel_d_point.norm());
  }
}

TEST_P(CameraModelOfLens, JacobianByIntrinsicsMatchesNumericDerivative) {
  const CameraParameters& p = GetParam().parameters;
  for (const Eigen::Vector2d& pixel : random_pixels(50)) {
    // Towards the middle, where changed coefficients keep the point in the domain.
    const Eigen::Vector2d middle(p.pu_px, p.pv_px);
    const Eigen::Vector3d point = 5 * *model_.bearing(middle + 0.8 * (pixel - middle));
    IntrinsicsJacobian analytic;
    ASSERT_TRUE(model_.project_with_jacobian(point, &analytic));
    const auto numeric = test::numeric_jacobian<2, kIntrinsicNumbers>(
        [&](const IntrinsicsVector& delta) {
          return *CameraModel::create(with_intrinsics(p, intrinsics_of(p) + delta))->project(point);
        },
        1e-4);
    ASSERT_LT((analytic - numeric).cwiseAbs().maxCoeff(), 1e-6 * analytic.norm());
  }
}

TEST_P(CameraModelOfLens, TheAxisIsNoSpecialPlace) {
  const CameraParameters& p = GetParam().parameters;
  IntrinsicsJacobian intrinsics;
  const auto on_axis = model_.project_with_jacobian({0, 0, 2}, &intrinsics);
  ASSERT_TRUE(on_axis);
  EXPECT_LT((on_axis->pixel - Eigen::Vector2d(p.pu_px, p.pv_px)).norm(), 1e-12);
  EXPECT_TRUE(intrinsics.allFinite());
  for (const double beside : {1e-300, 1e-12, 1e-9, 1e-8, 1e-6}) {
    const auto near = model_.project_with_jacobian({beside, -beside, 2}, &intrinsics);
    ASSERT_TRUE(near);
    EXPECT_TRUE(intrinsics.allFinite());
    EXPECT_LT((near->d_pixel_d_point - on_axis->d_pixel_d_point).norm(), 0.01) << beside;
  }
  EXPECT_TRUE(model_.bearing({p.pu_px, p.pv_px})->isApprox(Eigen::Vector3d::UnitZ(), 1e-15));
}

TEST_P(CameraModelOfLens, WhatIsOutsideTheDomainHasNoPixel) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& x :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(nan, 0, 1),
        Eigen::Vector3d(0, 0, nan), Eigen::Vector3d(infinity, 0, 1)}) {
    EXPECT_FALSE(model_.project(x)) << x.transpose();
    EXPECT_FALSE(model_.project_with_jacobian(x)) << x.transpose();
  }
  EXPECT_FALSE(model_.bearing({nan, 0}));
  EXPECT_FALSE(model_.bearing({0, infinity}));
}

TEST(CameraModel, NoneIsThePinhole) {
  const CameraModel model = model_of(kLenses[0].parameters);
  EXPECT_TRUE(model.project({0.1, -0.2, 1})
                  ->isApprox(Eigen::Vector2d(611.5 + 170.2, 511.5 - 340.4), 1e-15));
  EXPECT_FALSE(model.project({0.1, 0, -1}));
  EXPECT_FALSE(model.project({0.1, 0, 0}));
}

TEST(CameraModel, ImpossibleParametersAreRefused) {
  const CameraParameters good = kLenses[1].parameters;
  const auto refused = [&](auto change) {
    CameraParameters p = good;
    change(p);
    const auto model = CameraModel::create(p);
    return !model && model.error().kind == ErrorKind::bad_data;
  };
  EXPECT_FALSE(refused([](CameraParameters&) {}));
  EXPECT_TRUE(refused([](auto& p) { p.width_px = 0; }));
  EXPECT_TRUE(refused([](auto& p) { p.height_px = -1; }));
  EXPECT_TRUE(refused([](auto& p) { p.fu_px = 0; }));
  EXPECT_TRUE(refused([](auto& p) { p.fv_px = -1500; }));
  EXPECT_TRUE(refused([](auto& p) { p.pu_px = std::nan(""); }));
  for (const double beyond : {1e-300, 0.9, 1.1e7, 1e300}) {
    EXPECT_TRUE(refused([&](auto& p) { p.fu_px = beyond; })) << beyond;
    EXPECT_TRUE(refused([&](auto& p) { p.fv_px = beyond; })) << beyond;
  }
  for (const double beyond : {-1.1e6, 1.1e6, 1e300}) {
    EXPECT_TRUE(refused([&](auto& p) { p.pu_px = beyond; })) << beyond;
    EXPECT_TRUE(refused([&](auto& p) { p.pv_px = beyond; })) << beyond;
  }
  EXPECT_TRUE(refused([](auto& p) { p.coefficients[3] = HUGE_VAL; }));
  // A fisheye's picture read with a narrow lens's polynomial.
  EXPECT_TRUE(refused([](auto& p) { p.coefficients = {-1.5, 0, 0, 0}; }));
}

TEST(CameraModel, CoversTheImageUnlessTheCalibrationEndsInIt) {
  for (const Lens& lens : kLenses) {
    const CameraModel model = model_of(lens.parameters);
    CameraParameters p = lens.parameters;
    const double found_px = model.valid_radius_px();
    EXPECT_TRUE(model.covers({p.pu_px, p.pv_px}));
    p.valid_radius_px = 200;
    const CameraModel stated = model_of(p);
    EXPECT_EQ(stated.valid_radius_px(), 200) << lens.name;
    EXPECT_TRUE(stated.covers({p.pu_px + 199.9, p.pv_px}));
    EXPECT_FALSE(stated.covers({p.pu_px, p.pv_px - 200.1}));
    // It says nothing of where a point is seen.
    EXPECT_EQ(stated.project({0.1, 0.2, 1}), model.project({0.1, 0.2, 1}));
    p.valid_radius_px = 1e5;
    EXPECT_EQ(model_of(p).valid_radius_px(), std::min(found_px, 1e5)) << lens.name;
  }
  EXPECT_TRUE(std::isinf(model_of(kLenses[0].parameters).valid_radius_px()));
  EXPECT_TRUE(std::isinf(model_of(kLenses[1].parameters).valid_radius_px()));
}

TEST(CameraModel, WhatTurnsOverInTheImageIsValidUpToThere) {
  // A webcam's polynomial fitted to the middle only: its corners are no part of it.
  const CameraParameters p{
      640, 480, 560, 560, 320, 240, Distortion::radtan5, {-0.3, 0.1, 0, 0, -0.2}};
  const CameraModel model = model_of(p);
  const double radius_px = model.valid_radius_px();
  EXPECT_LT(radius_px, 400);
  EXPECT_GT(radius_px, 200);
  for (double angle = 0; angle < 6.28; angle += 0.1) {
    const Eigen::Vector2d pixel(320 + (radius_px - 1e-6) * std::cos(angle),
                                240 + (radius_px - 1e-6) * std::sin(angle));
    EXPECT_TRUE(model.covers(pixel));
    const auto bearing = model.bearing(pixel);
    ASSERT_TRUE(bearing);
    EXPECT_LT((*model.project(*bearing) - pixel).norm(), 1e-9);
  }
  EXPECT_FALSE(model.covers({-0.5, -0.5}));
  EXPECT_FALSE(model.covers_all(std::array{Eigen::Vector2d(320, 240), Eigen::Vector2d(0, 0)}));
}

TEST(CameraModel, ATrackingCamerasFisheyeIsRead) {
  // Of an Intel T265; the polynomial ends before the corners.
  const CameraModel model = model_of(
      {848, 800, 286.18, 286.37, 421.31, 398.97, kFisheye, {-0.00797, 0.04525, -0.04229, 0.00759}});
  EXPECT_TRUE(model.covers({0, 399}));
}

TEST(CameraModel, InImageIsHalfOpenAtPixelEdges) {
  const CameraModel model = model_of(kLenses[4].parameters);
  EXPECT_TRUE(model.in_image({-0.5, -0.5}));
  EXPECT_FALSE(model.in_image({-0.51, 0}));
  EXPECT_TRUE(model.in_image({751.49, 479.49}));
  EXPECT_FALSE(model.in_image({751.5, 0}));
  EXPECT_FALSE(model.in_image({0, 479.5}));
  EXPECT_FALSE(model.in_image({std::nan(""), 0}));
}

}  // namespace
}  // namespace waymark
