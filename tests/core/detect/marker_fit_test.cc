#include "core/detect/marker_fit.h"

#include <gtest/gtest.h>

#include "core/detect/corner_refiner.h"
#include "tests/support/corner_trials.h"
#include "tests/support/edge_trials.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::render_markers;
using testing::RenderedMarker;
using testing::RenderOptions;
using testing::trial_camera;

RenderedMarker seen(const CameraModel& camera, const MarkerView& view) {
  RenderedMarker marker;
  marker.id = {Family::tag36h11, 7};
  marker.cam_from_marker = pose_seen_as(camera, view, marker.size_m);
  return marker;
}

MarkerView tilted() {
  return {.center_px = {150, 170},
          .mean_side_px = 90,
          .tilt_rad = 0.6,
          .azimuth_rad = 0.5,
          .roll_rad = 0.3};
}

double largest_error_px(const ImageCorners& a, const ImageCorners& b) {
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(MarkerFit, FindsTheCornersUnderTheRightResponse) {
  const CameraModel camera = trial_camera(Distortion::radtan);
  for (const bool srgb : {false, true}) {
    const RenderedMarker marker = seen(camera, tilted());
    RenderOptions options;
    options.srgb = srgb;
    options.noise_grey = 0.5;
    const GrayImage image = render_markers(camera, {&marker, 1}, options);
    const ImageCorners truth = true_corners(camera, marker);
    const MarkerBits bits = marker_bits(marker.id);
    const auto refined = refine_corners(image.view(), camera, truth, bits);
    ASSERT_TRUE(refined);
    const auto fits = fit_marker(image.view(), camera, refined->corners, bits);
    ASSERT_TRUE(fits);
    const SensorResponse right = srgb ? SensorResponse::srgb : SensorResponse::linear;
    const SensorResponse wrong = srgb ? SensorResponse::linear : SensorResponse::srgb;
    ASSERT_TRUE(fits->of(right));
    EXPECT_LT(largest_error_px(fits->of(right)->corners, truth), 0.03) << srgb;
    EXPECT_NEAR(fits->of(right)->growth_px, 0, 0.02);
    EXPECT_NEAR(fits->of(right)->inset_px, inset_px(refined->corners, truth), 0.01);
    // The point spread and the pixel's square.
    EXPECT_NEAR(fits->of(right)->blur_px, std::hypot(options.psf_sigma_px, 0.289), 0.03);
    EXPECT_LT(fits->of(right)->misfit, fits->of(wrong)->misfit);
    EXPECT_EQ(fits->clipped_share, 0);
  }
}

TEST(MarkerFit, TellsClippedPixels) {
  const CameraModel camera = trial_camera();
  RenderedMarker marker = seen(camera, tilted());
  marker.white = 400;
  const GrayImage image = render_markers(camera, {&marker, 1}, {});
  const auto fits =
      fit_marker(image.view(), camera, true_corners(camera, marker), marker_bits(marker.id));
  ASSERT_TRUE(fits);
  EXPECT_GT(fits->clipped_share, 0.2);
}

TEST(MarkerFit, IsTheSameEveryTime) {
  const CameraModel camera = trial_camera();
  const RenderedMarker marker = seen(camera, tilted());
  const GrayImage image = render_markers(camera, {&marker, 1}, {});
  const ImageCorners corners = true_corners(camera, marker);
  const auto once = fit_marker(image.view(), camera, corners, marker_bits(marker.id));
  const auto again = fit_marker(image.view(), camera, corners, marker_bits(marker.id));
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->of(SensorResponse::linear)->corners, again->of(SensorResponse::linear)->corners);
}

TEST(MarkerFit, WhatIsNoMarkerHasNone) {
  const CameraModel camera = trial_camera();
  const GrayImage image(320, 320, 120);
  const MarkerBits bits = marker_bits({Family::tag36h11, 7});
  const ImageCorners on_a_line{{{10, 10}, {50, 50}, {90, 90}, {130, 130}}};
  EXPECT_FALSE(fit_marker(image.view(), camera, on_a_line, bits));
  const ImageCorners outside{{{900, 900}, {950, 900}, {950, 950}, {900, 950}}};
  EXPECT_FALSE(fit_marker(image.view(), camera, outside, bits));
  const ImageCorners tiny{{{100, 100}, {103, 100}, {103, 103}, {100, 103}}};
  EXPECT_FALSE(fit_marker(image.view(), camera, tiny, bits));
}

TEST(MarkerFit, PartlyOutsideTheImageIsFittedByWhatIsThere) {
  const CameraModel camera = trial_camera();
  MarkerView view = tilted();
  view.center_px = {40, 160};
  const RenderedMarker marker = seen(camera, view);
  const GrayImage image = render_markers(camera, {&marker, 1}, {});
  const ImageCorners truth = true_corners(camera, marker);
  const auto fits = fit_marker(image.view(), camera, truth, marker_bits(marker.id));
  ASSERT_TRUE(fits && fits->of(SensorResponse::linear));
  EXPECT_LT(largest_error_px(fits->of(SensorResponse::linear)->corners, truth), 0.3);
}

}  // namespace
}  // namespace waymark
