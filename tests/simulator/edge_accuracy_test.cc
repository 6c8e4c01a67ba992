#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>

#include "core/camera/camera_model.h"
#include "core/marker/marker_geometry.h"
#include "simulator/random.h"
#include "simulator/renderer.h"
#include "simulator/rig_library.h"
#include "simulator/scene_layout.h"

namespace waymark::simulator {
namespace {

/// A wall with one marker, and nothing else that could move an edge.
Scene one_marker_scene(double tilt_deg, double roll_deg) {
  Scene scene;
  scene.name = "edge";
  scene.room_size_m = {6, 6, 6};
  scene.surfaces = room_faces(scene.room_size_m);
  scene.catalog = MarkerCatalog({{.family = Family::aruco_4x4_1000,
                                  .default_size_m = 0.30,
                                  .size_m_by_id = {},
                                  .ignored = {}}});
  const Surface& wall = scene.surfaces[2];
  Eigen::Matrix3d axes;
  axes << wall.right, wall.up, wall.normal();
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(tilt_deg * kRadPerDeg, Eigen::Vector3d(0.6, 0.8, 0).normalized()) *
      Eigen::AngleAxisd(roll_deg * kRadPerDeg, Eigen::Vector3d::UnitZ()));
  scene.markers.push_back(
      {{Family::aruco_4x4_1000, 7},
       0.30,
       {Eigen::Quaterniond(axes) * turn, wall.point(3, 3) + 0.3 * wall.normal()},
       2});
  return scene;
}

/// No noise, no texture, no lamps, no vignetting.
RenderSettings plain_settings(double psf_sigma_px) {
  RenderSettings settings;
  settings.texture_contrast = 0;
  settings.uniform_light = true;
  settings.vignetting = 0;
  settings.noise = false;
  settings.psf_sigma_px = psf_sigma_px;
  return settings;
}

/// Value of the image at a point between pixels.
double bilinear(const IrradianceImage& image, const Eigen::Vector2d& at) {
  const int x = static_cast<int>(std::floor(at.x()));
  const int y = static_cast<int>(std::floor(at.y()));
  const auto value = [&](int i, int j) {
    return static_cast<double>(image.values[static_cast<std::size_t>(j * image.width_px + i)]);
  };
  const double fx = at.x() - x;
  const double fy = at.y() - y;
  return (1 - fy) * ((1 - fx) * value(x, y) + fx * value(x + 1, y)) +
         fy * ((1 - fx) * value(x, y + 1) + fx * value(x + 1, y + 1));
}

/// How far (px) outside its projection an edge lies: the grey along the normal is integrated, for
/// blur moves no light across a straight edge's place but symmetrically. Mean over the middle of
/// the edge.
double edge_offset_px(const IrradianceImage& image, const CameraModel& camera,
                      const Rigid3& cam_from_marker, const Eigen::Vector3d& from,
                      const Eigen::Vector3d& to, double reach_px) {
  constexpr int kLines = 64;
  constexpr double kStep_px = 0.02;
  double sum = 0;
  for (int i = 0; i < kLines; ++i) {
    const double share = 0.25 + 0.5 * (i + 0.5) / kLines;
    const auto at = [&](double s) {
      return *camera.project(cam_from_marker * (from + s * (to - from)));
    };
    const Eigen::Vector2d on_edge = at(share);
    const Eigen::Vector2d along = (at(share + 0.01) - at(share - 0.01)).normalized();
    const Eigen::Vector2d outward(along.y(), -along.x());  // corners run clockwise in the image
    const double black = bilinear(image, on_edge - reach_px * outward);
    const double white = bilinear(image, on_edge + reach_px * outward);
    double area = 0;
    for (double d = -reach_px + kStep_px / 2; d < reach_px; d += kStep_px) {
      area += kStep_px * (bilinear(image, on_edge + d * outward) - black) / (white - black);
    }
    sum += reach_px - area;
  }
  return sum / kLines;
}

struct View {
  double distance_m, tilt_deg, roll_deg, psf_sigma_px;
};

/// What GoogleTest shows as the parameter.
void PrintTo(const View& view, std::ostream* out) {
  *out << view.distance_m << " m, " << view.tilt_deg << " deg, " << view.psf_sigma_px << " px";
}

class EdgeAccuracy : public testing::TestWithParam<View> {};

INSTANTIATE_TEST_SUITE_P(Views, EdgeAccuracy,
                         testing::Values(View{2.5, 0, 0, 0.7}, View{2.5, 5, 11, 0.7},
                                         View{3.5, 40, 33, 0.7}, View{2.0, 60, 8, 1.0},
                                         View{4.5, 20, 0.4, 0.6}));

TEST_P(EdgeAccuracy, EdgesLieOnTheirProjections) {
  const View view = GetParam();
  const Scene scene = one_marker_scene(view.tilt_deg, view.roll_deg);
  auto rig = load_rig("cg60");
  ASSERT_TRUE(rig.has_value());
  rig->rig.cameras.erase(rig->rig.cameras.begin() + 1, rig->rig.cameras.end());
  const Renderer renderer(scene, rig->rig, plain_settings(view.psf_sigma_px), 1);
  const PlacedMarker& marker = scene.markers.front();
  const CameraModel& camera = rig->rig.cameras[0].model;
  Random random(42);
  // Several places in the image, as lens and pixel phase differ.
  for (int trial = 0; trial < 4; ++trial) {
    const Surface& wall = scene.surfaces[2];
    Eigen::Matrix3d world_from_level_cam;  // x right, y down, z towards the wall
    world_from_level_cam << wall.right, -wall.up, -wall.normal();
    const Rigid3 world_from_cam{
        Eigen::Quaterniond(world_from_level_cam) *
            Eigen::AngleAxisd(random.uniform(-0.2, 0.2), Eigen::Vector3d::UnitZ()),
        marker.world_from_marker.translation + view.distance_m * wall.normal() +
            random.uniform(-0.2, 0.2) * wall.right + random.uniform(-0.15, 0.15) * wall.up};
    const IrradianceImage image = renderer.irradiance(0, [&](double) { return world_from_cam; });
    const Rigid3 cam_from_marker = world_from_cam.inverse() * marker.world_from_marker;
    const auto corners = marker_corners(marker.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      const double offset_px = edge_offset_px(image, camera, cam_from_marker, corners[i],
                                              corners[(i + 1) % 4], 5.0 * view.psf_sigma_px);
      EXPECT_NEAR(offset_px, 0.0, 0.01) << "trial " << trial << " edge " << i;
    }
  }
}

}  // namespace
}  // namespace waymark::simulator
