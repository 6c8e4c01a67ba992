#include "core/detect/marker_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/marker/marker_outline.h"
#include "tests/support/corner_trials.h"
#include "tests/support/numeric_jacobian.h"

namespace waymark {
namespace {

/// A marker that is seen from the side, through a lens, in front of grey.
struct Seen {
  explicit Seen(double side_px = 60) {
    const testing::MarkerView view{.center_px = {150, 170},
                                   .mean_side_px = side_px,
                                   .tilt_rad = 0.6,
                                   .azimuth_rad = 0.5,
                                   .roll_rad = 0.3};
    marker.id = {Family::tag36h11, 7};
    marker.cam_from_marker = pose_seen_as(camera, view, marker.size_m);
    image = testing::render_markers(camera, {&marker, 1}, {});
    corners = true_corners(camera, marker);
  }
  [[nodiscard]] MarkerPixels pixels() const {
    return {image.view(), camera, corners, marker_bits(marker.id)};
  }

  CameraModel camera = testing::trial_camera(Distortion::radtan);
  testing::RenderedMarker marker;
  GrayImage image;
  ImageCorners corners;
};

TEST(MarkerShape, KeepsItsCorners) {
  const Seen seen;
  const MarkerShape shape = shape_at(seen.corners, 0.5);
  EXPECT_EQ(corners_of(shape), seen.corners);
  EXPECT_NEAR(std::exp(shape[kShapeBlur]), 0.25, 1e-12);
  EXPECT_EQ(shape[kShapeGrowth], 0);
}

TEST(MarkerPixels, AreThoseOfTheMarkerAndItsMargin) {
  const Seen seen(20);
  const MarkerPixels pixels = seen.pixels();
  // With 0.55 of ten cells' width on each side, tilted as the marker is.
  const double cells = 8;
  const double expected = area_px2(seen.corners) * (cells + 1.1) * (cells + 1.1) / (cells * cells);
  EXPECT_NEAR(static_cast<double>(pixels.all().size()), expected, 0.05 * expected);
}

TEST(MarkerPixels, OfLargeMarkersAreSixHundredAtEdgesAndTwoHundredOthers) {
  const Seen seen(150);
  const MarkerPixels pixels = seen.pixels();
  EXPECT_EQ(pixels.all().size(), 800U);
  std::vector<PixelWhiteness> whiteness;
  ASSERT_TRUE(pixels.look(shape_at(seen.corners, 0.5), whiteness));
  const auto grey = [](const PixelWhiteness& w) { return w.value > 0.001 && w.value < 0.999; };
  const auto at_edges = std::count_if(whiteness.begin(), whiteness.end(), grey);
  EXPECT_GT(at_edges, 200);
  // None of the others sees one.
  EXPECT_EQ(std::count_if(whiteness.begin() + 600, whiteness.end(), grey), 0);
}

TEST(MarkerPixels, LookAsWhiteAsTheImageIsBright) {
  const Seen seen;
  const MarkerPixels pixels = seen.pixels();
  std::vector<PixelWhiteness> whiteness;
  ASSERT_TRUE(pixels.look(shape_at(seen.corners, 0.8), whiteness));
  ASSERT_EQ(whiteness.size(), pixels.all().size());
  double squares = 0;
  for (std::size_t i = 0; i < whiteness.size(); ++i) {
    // The renderer's black is 40, its white 210.
    const double white = (255 * pixels.all()[i].grey - 40) / 170;
    squares += (white - whiteness[i].value) * (white - whiteness[i].value);
  }
  // Noise is 2 of 170.
  EXPECT_LT(std::sqrt(squares / static_cast<double>(whiteness.size())), 0.03);
}

TEST(MarkerPixels, DerivativesAreThoseOfDifferences) {
  const Seen seen;
  const MarkerPixels pixels = seen.pixels();
  MarkerShape shape = shape_at(seen.corners, 0.9);
  shape[kShapeBlur + 1] = 0.1;
  shape[kShapeBlur + 2] = -0.05;
  shape[kShapeGrowth] = 0.1;
  std::vector<PixelWhiteness> whiteness;
  ASSERT_TRUE(pixels.look(shape, whiteness));
  constexpr double kStep = 0.02;
  for (Eigen::Index k = 0; k < shape.size(); ++k) {
    std::vector<PixelWhiteness> after;
    std::vector<PixelWhiteness> before;
    ASSERT_TRUE(pixels.look(shape + kStep * MarkerShape::Unit(k), after));
    ASSERT_TRUE(pixels.look(shape - kStep * MarkerShape::Unit(k), before));
    double off = 0;
    double all = 0;
    for (std::size_t i = 0; i < whiteness.size(); ++i) {
      const double numeric = (after[i].value - before[i].value) / (2 * kStep);
      off += std::pow(numeric - whiteness[i].by_shape[k], 2);
      all += numeric * numeric;
    }
    // A corner's derivatives leave out how the blur's width in cells and its direction follow the
    // corner: 4 % at a tilt of 0.6 and a blur of a fifth of a cell.
    const double left_out = k < kShapeBlur ? 0.05 : 0.001;
    EXPECT_LT(std::sqrt(off / all), left_out) << "number " << k;
  }
}

TEST(MarkerPixels, WhatIsNoMarkerHasNoneAndLooksLikeNothing) {
  const Seen seen;
  // Without distortion a line in the image is one in the marker's plane.
  const CameraModel camera = testing::trial_camera(Distortion::none);
  const ImageCorners line{{{10, 10}, {50, 50}, {90, 90}, {130, 130}}};
  const MarkerBits bits = marker_bits(seen.marker.id);
  const MarkerPixels none(seen.image.view(), camera, line, bits);
  EXPECT_TRUE(none.all().empty());
  std::vector<PixelWhiteness> whiteness;
  EXPECT_FALSE(none.look(shape_at(line, 0.5), whiteness));
  const MarkerPixels some(seen.image.view(), camera, seen.corners, bits);
  EXPECT_TRUE(some.look(shape_at(seen.corners, 0.5), whiteness));
  EXPECT_FALSE(some.look(shape_at(line, 0.5), whiteness));
}

}  // namespace
}  // namespace waymark
