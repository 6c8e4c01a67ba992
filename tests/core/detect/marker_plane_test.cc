#include "core/detect/marker_plane.h"

#include <gtest/gtest.h>

#include "tests/support/corner_trials.h"
#include "tests/support/numeric_jacobian.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

TEST(MarkerPlane, LeadsThereAndBack) {
  const CameraModel camera = test::ring_rig(1).cameras[0].model;
  const MarkerPlane plane(camera, *camera.bearing({900, 300}));
  EXPECT_LT(plane.plane_from_pixel({900, 300})->norm(), 1e-12) << "the marker's own direction";
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(850, 250), Eigen::Vector2d(1279, 959)}) {
    const auto there = plane.plane_from_pixel(pixel);
    ASSERT_TRUE(there);
    EXPECT_LT((*plane.pixel_from_plane(*there) - pixel).norm(), 1e-8);
  }
}

TEST(MarkerPlane, StraightSidesOfAMarkerAreStraightInIt) {
  const CameraModel camera = test::ring_rig(1).cameras[0].model;
  const MarkerPlane plane(camera, Eigen::Vector3d(0.3, 0.2, 1).normalized());
  const Eigen::Vector3d start(0.5, 0.5, 2);
  const Eigen::Vector3d end(0.9, 0.6, 2.2);
  const Eigen::Vector2d a = *plane.plane_from_pixel(*camera.project(start));
  const Eigen::Vector2d along = *plane.plane_from_pixel(*camera.project(end)) - a;
  for (const double share : {0.25, 0.5, 0.75}) {
    const Eigen::Vector2d p =
        *plane.plane_from_pixel(*camera.project(start + share * (end - start))) - a;
    EXPECT_NEAR(p.x() * along.y() - p.y() * along.x(), 0, 1e-12);
  }
}

TEST(MarkerPlane, SlopeIsThatOfDifferences) {
  const CameraModel camera = testing::trial_camera(Distortion::radtan);
  const MarkerPlane plane(camera, *camera.bearing({60, 40}));
  const Eigen::Vector2d point = *plane.plane_from_pixel({75, 52});
  const auto slope = plane.pixel_slope(point);
  ASSERT_TRUE(slope);
  const auto numeric = test::numeric_jacobian<2, 2>(
      [&](const Eigen::Vector2d& d) { return *plane.pixel_from_plane(point + d); }, 1e-6);
  EXPECT_LT((*slope - numeric).norm(), 1e-6 * numeric.norm());
}

TEST(MarkerPlane, ThereIsNothingAcrossTheMarkersDirection) {
  const CameraModel camera = test::ring_rig(1).cameras[0].model;
  const MarkerPlane sideways(camera, Eigen::Vector3d(1, 0, -0.2).normalized());
  EXPECT_FALSE(sideways.plane_from_pixel({0, 480}));
}

}  // namespace
}  // namespace waymark
