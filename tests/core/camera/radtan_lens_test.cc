#include "core/camera/radtan_lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/camera/camera_model.h"
#include "tests/support/numeric_jacobian.h"

namespace waymark {
namespace {

CameraModel model_of(const CameraParameters& parameters) {
  auto model = CameraModel::create(parameters);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return *std::move(model);
}

TEST(RadtanLens, IsOpenCvs) {
  // x' = x(1 + k1 r² + k2 r⁴) + 2 p1 x y + p2 (r² + 2x²), y' likewise, at (0.3, −0.2), r² = 0.13.
  const CameraModel model =
      model_of({1280, 1024, 900, 905, 640, 500, Distortion::radtan, {0.12, 0.03, 0.004, -0.006}});
  const double radial = 1 + 0.12 * 0.13 + 0.03 * 0.0169;
  const double x = 0.3 * radial + 2 * 0.004 * -0.06 + -0.006 * (0.13 + 0.18);
  const double y = -0.2 * radial + 0.004 * (0.13 + 0.08) + 2 * -0.006 * -0.06;
  EXPECT_TRUE(model.project({0.6, -0.4, 2})
                  ->isApprox(Eigen::Vector2d(900 * x + 640, 905 * y + 500), 1e-15));
}

TEST(RadtanLens, EndsWhereTheRadiusStopsGrowing) {
  // 1 + 3 k1 r² = 0 at r = 1.29099 for k1 = −0.2.
  CameraParameters p{600, 400, 500, 500, 300, 200, Distortion::radtan, {-0.2, 0, 0, 0}};
  const CameraModel model = model_of(p);
  const double end = std::sqrt(1 / 0.6);
  EXPECT_TRUE(model.project({end - 1e-6, 0, 1}));
  EXPECT_FALSE(model.project({end + 1e-6, 0, 1}));
  const double largest_px = 500 * end * (1 - 0.2 * end * end) + 300;
  EXPECT_TRUE(model.bearing({largest_px - 1e-3, 200}));
  EXPECT_FALSE(model.bearing({largest_px + 1e-3, 200}));
  // Tangential terms take a margin: 6 |(p1, p2)| r of the slope.
  p.coefficients = {-0.2, 0, 0.003, 0.004};
  const CameraModel tangential = model_of(p);
  const double margin_end = (-0.03 + std::sqrt(0.03 * 0.03 + 4 * 0.6)) / 1.2;
  EXPECT_TRUE(tangential.project({margin_end - 1e-6, 0, 1}));
  EXPECT_FALSE(tangential.project({margin_end + 1e-6, 0, 1}));
}

TEST(RadtanLens, IsOneToOneUpToItsEnd) {
  const CameraModel model =
      model_of({600, 400, 500, 500, 300, 200, Distortion::radtan, {-0.2, 0.01, 0.003, -0.004}});
  for (double angle = 0; angle < 6.28; angle += 0.1) {
    for (double radius = 0.05; radius < 1.25; radius += 0.05) {
      const Eigen::Vector3d x(radius * std::cos(angle), radius * std::sin(angle), 1);
      const auto pixel = model.project(x);
      if (!pixel) continue;
      const auto back = model.bearing(*pixel);
      ASSERT_TRUE(back) << x.transpose();
      ASSERT_LT((*back - x.normalized()).norm(), 1e-9) << x.transpose();
    }
  }
}

TEST(RadtanLens, HasK3) {
  const CameraModel model = model_of(
      {1280, 1024, 900, 905, 640, 500, Distortion::radtan5, {0.12, 0.03, 0.004, -0.006, -0.05}});
  const double radial = 1 + 0.12 * 0.13 + 0.03 * 0.0169 - 0.05 * 0.002197;
  const double x = 0.3 * radial + 2 * 0.004 * -0.06 + -0.006 * (0.13 + 0.18);
  EXPECT_NEAR(model.project({0.6, -0.4, 2})->x(), 900 * x + 640, 1e-10);
}

TEST(RadtanLens, IsOpenCvsRational) {
  const CameraModel model = model_of({1280,
                                      1024,
                                      900,
                                      905,
                                      640,
                                      500,
                                      Distortion::rational,
                                      {0.12, 0.03, 0.004, -0.006, -0.05, 0.2, 0.02, 0.01}});
  const double radial = (1 + 0.12 * 0.13 + 0.03 * 0.0169 - 0.05 * 0.002197) /
                        (1 + 0.2 * 0.13 + 0.02 * 0.0169 + 0.01 * 0.002197);
  const double y = -0.2 * radial + 0.004 * (0.13 + 0.08) + 2 * -0.006 * -0.06;
  EXPECT_NEAR(model.project({0.6, -0.4, 2})->y(), 905 * y + 500, 1e-10);
}

TEST(RadtanLens, FewerCoefficientsAreTheSameLens) {
  const LensCoefficients k{-0.2, 0.05, 0.001, -0.002};
  const CameraModel four = model_of({640, 480, 500, 500, 320, 240, Distortion::radtan, k});
  for (const Distortion more : {Distortion::radtan5, Distortion::rational}) {
    const CameraModel other = model_of({640, 480, 500, 500, 320, 240, more, k});
    const Eigen::Vector3d x(0.4, -0.3, 1);
    EXPECT_LT((*other.project(x) - *four.project(x)).norm(), 1e-12);
    EXPECT_LT((*other.bearing({50, 60}) - *four.bearing({50, 60})).norm(), 1e-13);
  }
}

TEST(RadtanLens, EndsBeforeARationalsPole) {
  // 1 − 0.5 r² = 0 at r = 1.414; before, the radius grows beyond all bounds.
  const CameraModel model =
      model_of({640, 480, 500, 500, 320, 240, Distortion::rational, {0, 0, 0, 0, 0, -0.5}});
  EXPECT_TRUE(model.project({1.41, 0, 1}));
  EXPECT_FALSE(model.project({1.42, 0, 1}));
  EXPECT_FALSE(model.project({3, 0, 1}));
  EXPECT_TRUE(std::isinf(model.valid_radius_px()));
}

}  // namespace
}  // namespace waymark
