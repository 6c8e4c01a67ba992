#include "core/camera/sphere_lenses.h"

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

TEST(SphereLenses, EucmIsKhomutenkos) {
  const CameraModel model =
      model_of({1000, 1000, 300, 301, 500, 499, Distortion::eucm, {0.6, 1.1}});
  const double d = std::sqrt(1.1 * (0.36 + 0.16) + 4);
  const double depth = 0.6 * d + 0.4 * 2;
  EXPECT_TRUE(
      model.project({0.6, -0.4, 2})
          ->isApprox(Eigen::Vector2d(300 * 0.6 / depth + 500, -301 * 0.4 / depth + 499), 1e-15));
}

TEST(SphereLenses, DoubleSphereIsUsenkos) {
  const CameraModel model =
      model_of({1000, 1000, 240, 241, 500, 499, Distortion::double_sphere, {-0.2, 0.59}});
  const double d1 = std::sqrt(0.36 + 0.16 + 4);
  const double s = -0.2 * d1 + 2;
  const double depth = 0.59 * std::sqrt(0.36 + 0.16 + s * s) + 0.41 * s;
  EXPECT_TRUE(
      model.project({0.6, -0.4, 2})
          ->isApprox(Eigen::Vector2d(240 * 0.6 / depth + 500, -241 * 0.4 / depth + 499), 1e-15));
}

TEST(SphereLenses, WithoutAlphaArePinholes) {
  for (const Distortion kind : {Distortion::eucm, Distortion::double_sphere}) {
    const CameraModel model =
        model_of({640, 480, 500, 500, 320, 240, kind, {0, kind == Distortion::eucm ? 1.0 : 0.0}});
    EXPECT_LT((*model.project({0.4, -0.3, 1}) - Eigen::Vector2d(520, 90)).norm(), 1e-10);
    EXPECT_FALSE(model.project({0.4, -0.3, -0.01}));
  }
}

/// Lenses of 190° and beyond.
const CameraParameters kWide[] = {
    {1000, 1000, 301, 300, 500.5, 498, Distortion::eucm, {0.61, 1.08}},
    {1000, 1000, 180, 180, 500, 500, Distortion::eucm, {0.5, 1.0}},
    {1000, 1000, 242, 241, 500.5, 498, Distortion::double_sphere, {-0.19, 0.58}},
    {600, 600, 170, 170, 300, 300, Distortion::double_sphere, {-0.3, 0.65}},
    {1000, 1000, 200, 200, 500, 500, Distortion::double_sphere, {0.2, 0.5}},
};

TEST(SphereLenses, SeeBehindThemselves) {
  for (const CameraParameters& p : kWide) {
    const CameraModel model = model_of(p);
    double before = 0;
    for (double degrees = 1; degrees <= 100; degrees += 1) {
      const double theta = degrees * std::numbers::pi / 180;
      const Eigen::Vector3d x(std::sin(theta) * 0.6, std::sin(theta) * -0.8, std::cos(theta));
      const auto pixel = model.project(3 * x);
      ASSERT_TRUE(pixel) << to_string(p.distortion) << " " << degrees;
      const double radius = (*pixel - Eigen::Vector2d(p.pu_px, p.pv_px)).norm();
      EXPECT_GT(radius, before);
      before = radius;
      EXPECT_LT((*model.bearing(*pixel) - x).norm(), 1e-12);
      const auto jacobian = model.project_with_jacobian(x)->d_pixel_d_point;
      const auto numeric = test::numeric_jacobian<2, 3>(
          [&](const Eigen::Vector3d& delta) { return *model.project(x + delta); }, 1e-4);
      EXPECT_LT((jacobian - numeric).norm(), 1e-6 * jacobian.norm()) << degrees;
    }
  }
}

TEST(SphereLenses, EndWhereTheRadiusStopsGrowing) {
  for (const CameraParameters& p : kWide) {
    const CameraModel model = model_of(p);
    const auto at = [&](double theta) {
      return model.project({std::sin(theta), 0, std::cos(theta)});
    };
    double end = 0;
    while (end < std::numbers::pi && at(end + 1e-4)) end += 1e-4;
    // One-to-one up to there.
    for (double theta = 0; theta < end - 1e-3; theta += 0.01) {
      ASSERT_LT(at(theta)->x(), at(theta + 1e-3)->x());
    }
    const double largest_px = at(end)->x();
    EXPECT_TRUE(model.bearing({largest_px - 1e-3, p.pv_px}));
    const double alpha = p.coefficients[p.distortion == Distortion::eucm ? 0 : 1];
    if (alpha <= 0.5) continue;
    EXPECT_FALSE(model.bearing({largest_px + 1e-3, p.pv_px}));
    EXPECT_LT(model.valid_radius_px(), largest_px - p.pu_px);
  }
}

}  // namespace
}  // namespace waymark
