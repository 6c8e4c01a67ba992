#include "mapbuilder/diagnosis/misshapen_markers.h"

#include <cmath>
#include <random>

#include "core/marker/marker_geometry.h"
#include "tests/mapbuilder/diagnosis/diagnosed_room.h"

namespace waymark::test {
namespace {

/// Prints a marker `wider` times as wide as stated: every detection of it shows that, with noise.
void print_wider(SyntheticRoom& room, int id, double wider) {
  std::mt19937 random(static_cast<std::uint32_t>(id));
  std::normal_distribution<double> noise(0, 0.1);
  const Rigid3& world_from_marker = room.world_from_marker[static_cast<std::size_t>(id)];
  for (ImageDetections& image : room.images) {
    for (Detection& detection : image.detections) {
      if (detection.marker.number != id) continue;
      const auto set =
          static_cast<std::size_t>((image.stamp - room_stamp(0)) / std::chrono::milliseconds(100));
      const RigCamera& camera = room.rig.cameras[static_cast<std::size_t>(image.camera)];
      const Rigid3 cam_from_marker =
          (room.world_from_rig[set] * camera.rig_from_cam).inverse() * world_from_marker;
      auto corners = marker_corners(*room.catalog.size_m(detection.marker));
      for (std::size_t i = 0; i < 4; ++i) {
        corners[i].x() *= wider;
        detection.corners[i] = *camera.model.project(cam_from_marker * corners[i]) +
                               Eigen::Vector2d(noise(random), noise(random));
      }
    }
  }
}

class MisshapenMarkers : public DiagnosedRoom {};

TEST_F(MisshapenMarkers, OneThatIsBentIsNamedWithItsShapeAndLeftOut) {
  for (const double wider : {0.92, 0.95, 1.06}) {
    SyntheticRoom room = noisy_room();
    print_wider(room, 7, wider);
    build(room);
    expect_only(Cause::print_not_square, 7);
    EXPECT_NEAR(figure("wider than high"), 100 * (wider - 1), 0.4);
    EXPECT_EQ(mapped(7), nullptr);
    EXPECT_LT(worst_distance_m(room, {7}), 0.01);
  }
}

TEST_F(MisshapenMarkers, TwoThatAreBentAlikeAreOneFinding) {
  SyntheticRoom room = noisy_room();
  print_wider(room, 7, 0.95);
  print_wider(room, 12, 0.95);
  build(room);
  ASSERT_EQ(build_.findings.size(), 1U) << titles();
  EXPECT_EQ(build_.findings.front().cause, Cause::print_not_square);
  EXPECT_EQ(build_.findings.front().markers.size(), 2U);
}

TEST_F(MisshapenMarkers, TwoThatAreBentOtherwiseAreTwoFindings) {
  SyntheticRoom room = noisy_room();
  print_wider(room, 7, 0.95);
  print_wider(room, 12, 1.06);
  build(room);
  EXPECT_EQ(build_.findings.size(), 2U) << titles();
}

TEST_F(MisshapenMarkers, AShapeWithinThePrintsToleranceIsNotNamed) {
  SyntheticRoom room = noisy_room();
  print_wider(room, 7, 1.01);
  build(room);
  expect_nobody();
}

TEST_F(MisshapenMarkers, AMarkerOfAnotherSizeIsSquare) {
  SyntheticRoom room = noisy_room();
  auto entries = room.catalog.entries();
  entries.front().size_m_by_id[7] = 0.33;
  room.catalog = MarkerCatalog(entries);
  build(room);
  expect_only(Cause::size, 7);
}

}  // namespace
}  // namespace waymark::test
