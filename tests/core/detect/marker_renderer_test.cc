// The renderer is the truth that corner refinement is held against, so it is held against closed
// forms itself.

#include "tests/support/marker_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/corner_trials.h"
#include "tests/support/coverage_grid.h"

namespace waymark::testing {
namespace {

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Integral of the normal distribution function.
double integral(double x) {
  return x * normal_distribution(x) + std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi);
}

/// Mean over a pixel of a Gaussian step whose middle lies `outside_px` before the pixel's centre.
double blurred_step(double outside_px, double sigma_px) {
  return sigma_px *
         (integral((outside_px + 0.5) / sigma_px) - integral((outside_px - 0.5) / sigma_px));
}

class EdgePlace : public ::testing::TestWithParam<double> {};

TEST_P(EdgePlace, NoiseFreeEdgeLiesWithinTwoThousandthsOfItsProjection) {
  const CameraModel camera = trial_camera();
  RenderedMarker marker;
  marker.id = {Family::aruco_4x4_50, 0};
  marker.quiet_zone_cells = 2;
  const MarkerView view{{160 + GetParam(), 160}, 120, 0, 0, 0};
  marker.cam_from_marker = pose_seen_as(camera, view, 1.0);
  // Facing the line of sight is facing the image only in its middle: turn it parallel.
  marker.cam_from_marker.rotation = Eigen::Quaterniond(0, 1, 0, 0);
  const ImageCorners corners = true_corners(camera, marker);
  ASSERT_NEAR(corners[0].x(), corners[3].x(), 1e-9);

  for (const double sigma_px : {0.6, 1.0}) {
    RenderOptions options;
    options.noise_grey = 0;
    options.psf_sigma_px = sigma_px;
    const GrayImage image = render_markers(camera, {&marker, 1}, options);
    // The profile across the left side's middle, summed: the shift of its step is the sum's excess.
    const double edge = corners[0].x();
    double excess = 0;
    for (int x = static_cast<int>(edge) - 8; x <= static_cast<int>(edge) + 8; ++x) {
      const double black_share = blurred_step(x - edge, sigma_px);
      const double expected = marker.white + (marker.black - marker.white) * black_share;
      double grey = 0;
      constexpr int kRows = 20;
      for (int y = 150; y < 150 + kRows; ++y) grey += image.view().row(y)[x] / double{kRows};
      EXPECT_NEAR(grey, expected, 0.75) << "8-bit rounding allows half a grey level; x = " << x;
      excess += grey - expected;
    }
    EXPECT_LT(std::abs(excess) / (marker.white - marker.black), 0.012) << "rounding included";
  }
}

INSTANTIATE_TEST_SUITE_P(SubPixel, EdgePlace, ::testing::Values(0.0, 0.13, 0.37, 0.5, 0.81));

TEST(CoverageGrid, SlantedAndThinPolygonsKeepTheirArea) {
  const std::vector<Eigen::Vector2d> sliver{{2.3, 1.1}, {17.9, 3.4}, {17.7, 3.9}, {2.2, 1.7}};
  double area = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = sliver[i];
    const Eigen::Vector2d& b = sliver[(i + 1) % 4];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  CoverageGrid grid({-5, -5, 26, 16}, 6);
  grid.add(sliver, 100);
  std::vector<double> image(40 * 30, 0.0);
  grid.integrate_into(0.5, 40, image);
  double sum = 0;
  for (const double light : image) sum += light;
  EXPECT_NEAR(sum, 100 * area, 0.02 * area) << "what the blur throws over the image's edge is lost";
}

TEST(PoseSeenAs, GivesSideTiltAndPlace) {
  const CameraModel camera = trial_camera(Distortion::equidistant);
  const MarkerView view{{60, 250}, 40, 0.9, 2, 1};
  RenderedMarker marker;
  marker.cam_from_marker = pose_seen_as(camera, view, 0.25);
  marker.size_m = 0.25;
  EXPECT_NEAR(mean_side_px(true_corners(camera, marker)), 40, 1e-3);
  const Eigen::Vector3d normal = marker.cam_from_marker.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d towards_camera = -marker.cam_from_marker.translation.normalized();
  EXPECT_NEAR(std::acos(normal.dot(towards_camera)), 0.9, 1e-9);
  EXPECT_NEAR((*camera.project(marker.cam_from_marker.translation) - view.center_px).norm(), 0,
              1e-9);
}

TEST(RenderMarkers, IsSeeded) {
  const CameraModel camera = trial_camera();
  RenderedMarker marker;
  marker.cam_from_marker = pose_seen_as(camera, {{160, 160}, 60, 0.3, 0, 0}, 1.0);
  RenderOptions options;
  const GrayImage first = render_markers(camera, {&marker, 1}, options);
  EXPECT_EQ(first.pixels, render_markers(camera, {&marker, 1}, options).pixels);
  options.seed = 2;
  EXPECT_NE(first.pixels, render_markers(camera, {&marker, 1}, options).pixels);
}

}  // namespace
}  // namespace waymark::testing
