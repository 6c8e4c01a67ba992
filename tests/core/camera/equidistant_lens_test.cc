#include "core/camera/equidistant_lens.h"

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

TEST(EquidistantLens, IsKannalaBrandts) {
  const CameraModel model = model_of({1280,
                                      1024,
                                      470.338,
                                      470.521,
                                      639.698,
                                      524.42,
                                      Distortion::equidistant,
                                      {-0.013211, -0.00988947, 0.0121051, -0.00452971}});
  const double theta = 0.7;
  const double angle = theta - 0.013211 * std::pow(theta, 3) - 0.00988947 * std::pow(theta, 5) +
                       0.0121051 * std::pow(theta, 7) - 0.00452971 * std::pow(theta, 9);
  const Eigen::Vector2d direction(0.6, -0.8);
  const Eigen::Vector3d x(std::sin(theta) * 0.6, std::sin(theta) * -0.8, std::cos(theta));
  EXPECT_TRUE(
      model.project(4 * x)->isApprox(Eigen::Vector2d(470.338 * angle * direction.x() + 639.698,
                                                     470.521 * angle * direction.y() + 524.42),
                                     1e-14));
}

TEST(EquidistantLens, SeeBehindThemselves) {
  const CameraModel model = model_of({1000, 1000, 260, 260, 500, 500, Distortion::equidistant, {}});
  for (const double degrees : {89.0, 90.0, 91.0, 120.0, 170.0, 179.0}) {
    const double theta = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d x(std::sin(theta), 0, std::cos(theta));
    const auto pixel = model.project(x);
    ASSERT_TRUE(pixel) << degrees;
    EXPECT_NEAR(pixel->x(), 500 + 260 * theta, 1e-9);
    EXPECT_LT((*model.bearing(*pixel) - x).norm(), 1e-12);
    const auto jacobian = model.project_with_jacobian(x)->d_pixel_d_point;
    const auto numeric = test::numeric_jacobian<2, 3>(
        [&](const Eigen::Vector3d& delta) { return *model.project(x + delta); }, 1e-4);
    EXPECT_LT((jacobian - numeric).norm(), 1e-6 * jacobian.norm()) << degrees;
  }
}

TEST(EquidistantLens, EndsWhereTheAngleStopsGrowing) {
  // 1 + 3 k1 θ² = 0 at θ = 1.8257 (104.6°) for k1 = −0.1.
  const CameraModel model =
      model_of({600, 400, 300, 300, 300, 200, Distortion::equidistant, {-0.1, 0, 0, 0}});
  const double end = std::sqrt(1 / 0.3);
  const auto towards = [](double theta) {
    return Eigen::Vector3d(0, std::sin(theta), std::cos(theta));
  };
  EXPECT_TRUE(model.project(towards(end - 1e-6)));
  EXPECT_FALSE(model.project(towards(end + 1e-6)));
  const double largest_px = 200 + 300 * end * (1 - 0.1 * end * end);
  EXPECT_TRUE(model.bearing({300, largest_px - 1e-3}));
  EXPECT_FALSE(model.bearing({300, largest_px + 1e-3}));
}

}  // namespace
}  // namespace waymark
