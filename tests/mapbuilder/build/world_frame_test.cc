#include "mapbuilder/build/world_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

MarkerId id(int number) { return {Family::tag36h11, number}; }

/// A hall's walls with `count` markers, 1 mm sure each; seeded noise of that size.
SubMap hall(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.0007);
  SubMap map;
  for (int i = 0; i < count; ++i) {
    MapMarker marker;
    marker.id = id(i);
    const double along = 1.3 * i;
    const bool left = i % 2 == 0;
    marker.world_from_marker = {so3_exp(Eigen::Vector3d(0, 0, left ? 0.0 : M_PI)) *
                                    so3_exp(Eigen::Vector3d(M_PI / 2, 0, 0)),
                                {along + noise(random), (left ? 4.0 : -4.0) + noise(random),
                                 1.0 + 0.3 * (i % 3) + noise(random)}};
    marker.covariance = 1e-6 * Matrix6d::Identity();
    map.markers.push_back(marker);
  }
  return map;
}

const Rigid3 kOldFromNew{so3_exp(Eigen::Vector3d(0.2, -0.1, 2.0)), {10, -3, 1}};

SubMap seen_from(SubMap map, const Rigid3& new_from_old) {
  for (MapMarker& marker : map.markers) {
    marker.world_from_marker = new_from_old * marker.world_from_marker;
  }
  return map;
}

TEST(CompareFrames, NamesExactlyWhatMovedAppearedAndVanished) {
  SubMap old = hall(30, 1);
  SubMap now = hall(30, 2);
  now.markers[4].world_from_marker.translation.x() += 0.05;
  now.markers[11].world_from_marker.translation.y() += 0.3;
  now.markers[20].world_from_marker.rotation =
      so3_exp(Eigen::Vector3d(0, 0, 0.17)) * now.markers[20].world_from_marker.rotation;
  now.markers.erase(now.markers.begin() + 7);   // vanished
  old.markers.erase(old.markers.begin() + 25);  // appeared
  const auto comparison = compare_frames(seen_from(now, kOldFromNew.inverse()), old);
  ASSERT_TRUE(comparison);
  std::vector<MarkerId> moved;
  for (const MovedMarker& marker : comparison->moved) moved.push_back(marker.id);
  EXPECT_EQ(moved, (std::vector<MarkerId>{id(4), id(11), id(20)}));
  EXPECT_EQ(comparison->appeared, std::vector<MarkerId>{id(25)});
  EXPECT_EQ(comparison->vanished, std::vector<MarkerId>{id(7)});
  EXPECT_EQ(comparison->unmoved, 25U);
  EXPECT_NEAR(comparison->moved[0].distance_m, 0.05, 0.003);
  EXPECT_NEAR(comparison->moved[2].turn_rad, 0.17, 0.005);
  const Vector6d off = comparison->old_from_new.minus(kOldFromNew);
  EXPECT_LT((comparison->old_from_new * Eigen::Vector3d(20, 0, 0) -
             kOldFromNew * Eigen::Vector3d(20, 0, 0))
                .norm(),
            std::sqrt(3.0) * 0.001)
      << "a waypoint stays within the map's own sigma, 1 mm an axis; " << off.transpose();
}

TEST(CompareFrames, SuspectsCarryNothingAndAreJudged) {
  const SubMap old = hall(30, 1);
  SubMap now = hall(30, 2);
  // Most of what is common has moved alike: without suspicion it would carry the frame away.
  std::set<MarkerId> suspects;
  for (int i = 0; i < 18; ++i) {
    now.markers[static_cast<std::size_t>(i)].world_from_marker.translation.x() += 0.5;
    suspects.insert(id(i));
  }
  suspects.insert(id(20));  // which has not
  const auto carried = compare_frames(now, old);
  ASSERT_TRUE(carried);
  EXPECT_EQ(carried->moved.size(), 12U);
  const auto comparison = compare_frames(now, old, suspects);
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->moved.size(), 18U);
  EXPECT_EQ(comparison->unmoved, 11U);
  ASSERT_EQ(comparison->suspects_in_place.size(), 1U);
  EXPECT_EQ(comparison->suspects_in_place[0].id, id(20));
}

TEST(CompareFrames, UnknownCovariancesLeaveThePlainLimits) {
  SubMap old = hall(20, 3);
  SubMap now = hall(20, 3);
  for (MapMarker& marker : now.markers) marker.covariance = unknown_covariance();
  now.markers[9].world_from_marker.translation.z() += 0.013;
  const auto comparison = compare_frames(now, old);
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->moved.size(), 1U);
}

TEST(CompareFrames, JustBelowTheLimitIsNotMovedJustAboveIs) {
  const SubMap old = hall(20, 3);
  for (const double shift_m : {0.008, 0.013}) {
    SubMap now = hall(20, 3);
    now.markers[9].world_from_marker.translation.z() += shift_m;
    const auto comparison = compare_frames(now, old);
    ASSERT_TRUE(comparison);
    EXPECT_EQ(comparison->moved.size(), shift_m > 0.01 ? 1U : 0U) << shift_m;
  }
}

TEST(CompareFrames, NeedsThreeMarkersThatAgree) {
  EXPECT_FALSE(compare_frames(hall(2, 1), hall(2, 2)));
  SubMap other = hall(10, 1);
  for (std::size_t i = 0; i < other.markers.size(); ++i) {
    other.markers[i].world_from_marker.translation *= 1.0 + 0.3 * static_cast<double>(i);
  }
  EXPECT_FALSE(compare_frames(other, hall(10, 2)));
}

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

TEST(MovedLimits, AreHeldToTheirRanges) {
  expect_ranges<MovedLimits>({ranged("distance_m", &MovedLimits::distance_m, {0.001, 1}),
                              ranged("turn_rad", &MovedLimits::turn_rad, {0.005, 0.5})});
}

}  // namespace
}  // namespace waymark
