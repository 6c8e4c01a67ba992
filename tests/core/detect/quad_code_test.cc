#include "core/detect/quad_code.h"

#include <gtest/gtest.h>

#include <bit>

#include "core/detect/code_table.h"
#include "tests/support/corner_trials.h"

namespace waymark {
namespace {

using testing::MarkerView;
using testing::RenderedMarker;

/// A marker in the middle of the trials' camera, and its corners.
struct Scene {
  GrayImage image;
  ImageCorners corners;
};

Scene scene_of(const MarkerId& id, double side_px, double tilt_rad = 0.2, double black = 40,
               double white = 210, double gradient_grey = 0) {
  const CameraModel camera = testing::trial_camera();
  RenderedMarker marker;
  marker.id = id;
  marker.black = black;
  marker.white = white;
  marker.cam_from_marker =
      pose_seen_as(camera, MarkerView{{160, 160}, side_px, tilt_rad, 0.3, 0.4}, marker.size_m);
  testing::RenderOptions options;
  options.gradient_grey = gradient_grey;
  return {testing::render_markers(camera, {&marker, 1}, options), true_corners(camera, marker)};
}

std::optional<CodeMatch> read(const Scene& scene, Family family) {
  const auto seen = read_quad_code(scene.image.view(), scene.corners, marker_layout(family), 10);
  if (!seen) return std::nullopt;
  std::vector<CodeMatch> matches;
  CodeTable({&family, 1}).find(marker_layout(family), seen->code, matches);
  if (matches.empty()) return std::nullopt;
  return matches.front();
}

TEST(QuadCode, ReadsMarkersOfAnySize) {
  for (const Family family : {Family::aruco_4x4_1000, Family::tag36h11, Family::aruco_7x7_250}) {
    const double cells = marker_layout(family).square_cells();
    for (const double cell_px : {2.4, 3.0, 5.0, 20.0}) {
      const auto match = read(scene_of({family, 77}, cells * cell_px), family);
      ASSERT_TRUE(match) << name_of(family) << ' ' << cell_px;
      EXPECT_EQ(match->marker.number, 77);
      EXPECT_EQ(match->turn, 0);
    }
  }
}

TEST(QuadCode, ReadsThemSeenAslantAndInUnevenLight) {
  const Family family = Family::tag36h11;
  for (const double gradient : {-300.0, 300.0}) {
    const auto match = read(scene_of({family, 12}, 60, 1.1, 30, 120, gradient), family);
    ASSERT_TRUE(match);
    EXPECT_EQ(match->wrong_bits, 0);
  }
}

TEST(QuadCode, ReadsLightSquaresInANegative) {
  for (const Family family :
       {Family::tagstandard41h12, Family::tagstandard52h13, Family::tagcircle21h7,
        Family::tagcircle49h12, Family::tagcustom48h12}) {
    for (const double cell_px : {4.0, 9.0}) {
      Scene scene = scene_of({family, 21}, marker_layout(family).square_cells() * cell_px);
      for (std::uint8_t& grey : scene.image.pixels) grey = static_cast<std::uint8_t>(~grey);
      const auto match = read(scene, family);
      ASSERT_TRUE(match) << name_of(family) << ' ' << cell_px;
      EXPECT_EQ(match->marker.number, 21);
      EXPECT_EQ(match->turn, 0);
    }
  }
}

TEST(QuadCode, NeedsContrast) {
  const Scene scene = scene_of({Family::tag36h11, 12}, 80, 0.2, 100, 125);
  EXPECT_TRUE(
      read_quad_code(scene.image.view(), scene.corners, marker_layout(Family::tag36h11), 15));
  EXPECT_FALSE(
      read_quad_code(scene.image.view(), scene.corners, marker_layout(Family::tag36h11), 40));
}

TEST(QuadCode, NeedsADarkBorder) {
  Scene scene = scene_of({Family::tag36h11, 12}, 80);
  EXPECT_TRUE(
      read_quad_code(scene.image.view(), scene.corners, marker_layout(Family::tag36h11), 10));
  for (std::uint8_t& grey : scene.image.pixels) grey = static_cast<std::uint8_t>(255 - grey);
  EXPECT_FALSE(
      read_quad_code(scene.image.view(), scene.corners, marker_layout(Family::tag36h11), 10));
}

TEST(QuadCode, TellsGreysFromCells) {
  const Scene scene = scene_of({Family::aruco_4x4_1000, 5}, 90);
  const auto right =
      read_quad_code(scene.image.view(), scene.corners, marker_layout(Family::aruco_4x4_1000), 10);
  const auto wrong =
      read_quad_code(scene.image.view(), scene.corners, marker_layout(Family::aruco_7x7_250), 10);
  ASSERT_TRUE(right);
  EXPECT_LT(right->greyness, 0.06);
  if (wrong) {
    EXPECT_GT(wrong->greyness, right->greyness);
  }
}

TEST(QuadCode, CornersOnALineOrOutsideShowNothing) {
  const GrayImage image(50, 50, 100);
  const MarkerLayout& layout = marker_layout(Family::aruco_4x4_50);
  EXPECT_FALSE(read_quad_code(image.view(), {{{0, 0}, {10, 10}, {20, 20}, {5, 30}}}, layout, 1));
  EXPECT_FALSE(
      read_quad_code(image.view(), {{{-90, -90}, {-10, -90}, {-10, -10}, {-90, -10}}}, layout, 1));
}

}  // namespace
}  // namespace waymark
