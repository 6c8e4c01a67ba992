#include "mapbuilder/build/world_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/hall_map.h"

namespace waymark {
namespace {

MarkerId id(int number) { return {Family::tag36h11, number}; }

using test::hall;

TEST(LevelWorld, WallsMakeZPointUp) {
  BuiltSubMap submap;
  submap.map = hall(12, 4);
  // A third wall, so that the two others' normals don't lie on one line.
  for (int i = 0; i < 4; ++i) {
    MapMarker marker = submap.map.markers[static_cast<std::size_t>(i)];
    marker.id = id(100 + i);
    marker.world_from_marker.rotation =
        so3_exp(Eigen::Vector3d(0, 0, M_PI / 2)) * marker.world_from_marker.rotation;
    submap.map.markers.push_back(marker);
  }
  const Rigid3 tilted{so3_exp(Eigen::Vector3d(0.4, 0.7, 0.1)), {1, 2, 3}};
  move_world(submap, tilted);
  const Eigen::Vector3d up = tilted.rotation * Eigen::Vector3d::UnitZ();
  const auto level = level_world(submap, LevelBy::walls, up);
  ASSERT_TRUE(level);
  EXPECT_LT((level->rotation * up - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  // Cameras upside down turn the map over.
  const auto over = level_world(submap, LevelBy::walls, -up);
  EXPECT_LT((over->rotation * up + Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(LevelWorld, TwoOppositeWallsDoNotTell) {
  BuiltSubMap submap;
  submap.map = hall(12, 4);
  EXPECT_FALSE(level_world(submap, LevelBy::walls, Eigen::Vector3d::UnitZ()));
}

TEST(MoveWorld, CarriesCovarianceAndTrajectoryAlong) {
  BuiltSubMap submap;
  submap.map = hall(3, 5);
  submap.map.markers[0].covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  submap.trajectory.push_back({FrameSetIndex(0), Rigid3{}});
  const Rigid3 turned{so3_exp(Eigen::Vector3d(0, 0, M_PI / 2)), {1, 0, 0}};
  move_world(submap, turned);
  Vector6d expected;
  expected << 2, 1, 3, 5, 4, 6;
  EXPECT_LT((submap.map.markers[0].covariance.diagonal() - expected).norm(), 1e-12);
  EXPECT_LT((submap.trajectory[0].world_from_rig.translation - Eigen::Vector3d(1, 0, 0)).norm(),
            1e-12);
}

}  // namespace
}  // namespace waymark
