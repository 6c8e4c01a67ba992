#include <fmt/format.h>

#include <random>

#include "mapbuilder/build/map_builder.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark {
namespace {

constexpr int kOtherHalf = 100;

/// A room whose second half of the walk sees other numbers on the walls: two captures' worth of
/// markers that no frame set sees together.
test::SyntheticRoom two_halves() {
  test::RoomOptions options;
  options.noise_px = 0.2;
  auto room = test::make_room(options);
  for (ImageDetections& image : room.images) {
    if (image.stamp < test::room_stamp(30)) continue;
    for (Detection& d : image.detections) d.marker.number += kOtherHalf;
  }
  return room;
}

const Rigid3 kFacilityFromRoom{so3_exp(Eigen::Vector3d(0.02, -0.03, 1.0)), {100, -20, 3}};

SurveyedPoint point_on(const test::SyntheticRoom& room, int number) {
  const Rigid3& pose = room.world_from_marker[static_cast<std::size_t>(number % kOtherHalf)];
  return {{{Family::tag36h11, number}, std::nullopt},
          kFacilityFromRoom * pose.translation,
          0.001,
          SurveyUse::fit};
}

BuildResult build(const Observations& observations, const BuildOptions& options) {
  Progress progress(false);
  return build_map(Selection(observations), options, progress);
}

/// Three points in each half join them.
BuildOptions with_three_points_in_each_half(const test::SyntheticRoom& room) {
  BuildOptions options;
  for (const int number : {0, 13, 27, 101, 114, 128}) {
    options.survey.points.push_back(point_on(room, number));
  }
  return options;
}

/// Largest distance of a marker of the sub-map from where it is in the facility frame (m).
double worst_off_m(const SubMap& map, const test::SyntheticRoom& room) {
  double worst = 0;
  for (const MapMarker& marker : map.markers) {
    const Rigid3& truth =
        room.world_from_marker[static_cast<std::size_t>(marker.id.number % kOtherHalf)];
    worst = std::max(
        worst,
        (marker.world_from_marker.translation - kFacilityFromRoom * truth.translation).norm());
  }
  return worst;
}

TEST(JoinedSubMaps, ThreePointsInEachHalfMakeOneMapOfThem) {
  const auto room = two_halves();
  const auto observations = test::observations_of(room);
  const BuildResult result = build(observations, with_three_points_in_each_half(room));
  ASSERT_EQ(result.submaps.size(), 1U);
  const BuiltSubMap& joined = result.submaps[0];
  EXPECT_EQ(joined.map.frame, FrameKind::facility);
  EXPECT_TRUE(joined.map.z_is_up);
  EXPECT_GT(joined.map.markers.size(), 60U);
  EXPECT_EQ(joined.trajectory.size(), 60U);
  EXPECT_LT(worst_off_m(joined.map, room), 0.01);
  EXPECT_TRUE(joined.covariances_known);
  for (const MapMarker& marker : joined.map.markers) {
    EXPECT_TRUE(marker.covariance_known());
    EXPECT_GT(marker.covariance(0, 0), 1e-8) << "three points of 1 mm tell no better";
  }
  for (const SurveyResidual& entry : joined.survey) EXPECT_TRUE(entry.mapped) << entry.entry;
}

TEST(JoinedSubMaps, ADistanceAcrossThemIsHeldOnceTheyAreJoined) {
  const auto room = two_halves();
  const auto observations = test::observations_of(room);
  BuildOptions options = with_three_points_in_each_half(room);
  const MarkerPlace from{{Family::tag36h11, 5}, std::nullopt};
  const MarkerPlace to{{Family::tag36h11, 118}, std::nullopt};
  const double true_m =
      (room.world_from_marker[5].translation - room.world_from_marker[18].translation).norm();
  options.survey.distances.push_back({from, to, true_m, 0.001, SurveyUse::fit});
  const BuildResult result = build(observations, options);
  ASSERT_EQ(result.submaps.size(), 1U);
  const SurveyResidual& across = result.submaps[0].survey.back();
  EXPECT_TRUE(across.mapped);
  EXPECT_LT(std::abs(across.residual_m), 0.004);
}

TEST(JoinedSubMaps, PointsInOneHalfOnlyLeaveTheOtherApart) {
  const auto room = two_halves();
  const auto plain_observations = test::observations_of(room);
  const BuildResult plain = build(plain_observations, {});
  ASSERT_EQ(plain.submaps.size(), 2U);
  const auto observations = test::observations_of(room);
  BuildOptions options;
  // Two points in the second half are one too few.
  for (const int number : {0, 13, 27, 101, 114}) {
    options.survey.points.push_back(point_on(room, number));
  }
  const BuildResult result = build(observations, options);
  ASSERT_EQ(result.submaps.size(), 2U);
  for (const BuiltSubMap& submap : result.submaps) {
    const bool first_half = submap.map.markers.front().id.number < kOtherHalf;
    EXPECT_EQ(submap.map.frame, first_half ? FrameKind::facility : FrameKind::arbitrary);
    EXPECT_EQ(submap.map.z_is_up, first_half);
    EXPECT_TRUE(submap.covariances_known);
    if (!first_half) continue;
    EXPECT_LT(worst_off_m(submap.map, room), 0.01);
  }
}

TEST(JoinedSubMaps, PointsOnALineOrOnOneMarkerDoNotJoin) {
  const auto room = two_halves();
  for (const bool one_marker : {true, false}) {
    const auto observations = test::observations_of(room);
    BuildOptions options;
    for (const int number : {0, 13, 27}) options.survey.points.push_back(point_on(room, number));
    for (const int corner : {0, 1, 2}) {
      SurveyedPoint point = point_on(room, 101);
      const Rigid3& pose = room.world_from_marker[1];
      const Eigen::Vector3d on_marker = marker_corners(0.3)[static_cast<std::size_t>(corner)];
      point.place.corner = corner;
      point.position_m = kFacilityFromRoom * (pose * on_marker);
      if (one_marker || corner == 0) options.survey.points.push_back(point);
    }
    const BuildResult result = build(observations, options);
    EXPECT_EQ(result.submaps.size(), 2U) << one_marker;
  }
}

}  // namespace
}  // namespace waymark
