#include "mapbuilder/build/frame_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_ranges.h"
#include "tests/support/hall_map.h"

namespace waymark {
namespace {

MarkerId id(int number) { return {Family::tag36h11, number}; }

using test::hall;
using test::seen_from;

const Rigid3 kOldFromNew{so3_exp(Eigen::Vector3d(0.2, -0.1, 2.0)), {10, -3, 1}};

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
  for (const ComparedMarker& marker : comparison->moved) moved.push_back(marker.id);
  EXPECT_EQ(moved, (std::vector<MarkerId>{id(4), id(11), id(20)}));
  EXPECT_EQ(comparison->appeared, std::vector<MarkerId>{id(25)});
  EXPECT_EQ(comparison->vanished, std::vector<MarkerId>{id(7)});
  EXPECT_EQ(comparison->stayed.size(), 25U);
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
  EXPECT_EQ(comparison->stayed.size(), 11U);
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

TEST(CompareFrames, SaysWhereToAndHowSure) {
  const SubMap old = hall(20, 3);
  SubMap now = hall(20, 3);
  now.markers[9].world_from_marker.translation.z() += 0.3;
  const auto comparison = compare_frames(seen_from(now, kOldFromNew.inverse()), old);
  ASSERT_TRUE(comparison);
  ASSERT_EQ(comparison->moved.size(), 1U);
  EXPECT_LT((comparison->moved[0].offset_m - Eigen::Vector3d(0, 0, 0.3)).norm(), 1e-9);
  EXPECT_NEAR(*comparison->moved[0].sigma_m, 0.001 * std::sqrt(2.0), 1e-9);
  EXPECT_EQ(comparison->stayed.size(), 19U);
}

TEST(CompareFrames, FewerMarkersCanAgreeWhereThatIsAskedFor) {
  const SubMap two = hall(2, 1);
  EXPECT_TRUE(compare_frames(hall(2, 2), two, {}, {}, 2));
  EXPECT_TRUE(compare_frames(hall(1, 2), two, {}, {}, 1));
  EXPECT_FALSE(compare_frames(hall(1, 2), two, {}, {}, 2));
}

TEST(CompareFrames, AThousandMarkersProposeByAFew) {
  SubMap old = hall(587, 1);
  SubMap now = hall(587, 2);
  // Two of five have moved, each elsewhere.
  for (std::size_t i = 0; i < now.markers.size(); ++i) {
    if (i % 5 < 2) now.markers[i].world_from_marker.translation.z() += 0.1 + 0.01 * double(i);
  }
  const auto comparison = compare_frames(seen_from(now, kOldFromNew.inverse()), old);
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->stayed.size(), 351U);
}

TEST(MovedLimits, AreHeldToTheirRanges) {
  expect_ranges<MovedLimits>({ranged("distance_m", &MovedLimits::distance_m, {0.001, 1}),
                              ranged("turn_rad", &MovedLimits::turn_rad, {0.005, 0.5})});
}

}  // namespace
}  // namespace waymark
