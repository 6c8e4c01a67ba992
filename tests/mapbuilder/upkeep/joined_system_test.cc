#include "mapbuilder/upkeep/joined_system.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/alignment.h"
#include "tests/mapbuilder/upkeep/kept_up_room.h"

namespace waymark {
namespace {

using test::BuiltRound;
using test::id;

test::RoomToday a_room(std::uint32_t seed = 1) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  today.options.seed = seed;
  return today;
}

KnownMarkers known_of(const BuiltRound& build) {
  KnownMarkers known;
  for (const MapMarker& marker : build.result.map.submaps[0].markers) {
    known.ids.push_back(marker.id);
  }
  known.system = systems_of_build(*build.parts)[0];
  return known;
}

/// A build's markers in the world of another.
KnownMarkers seen_in(const BuiltRound& round, const SubMap& world) {
  const auto comparison = compare_frames(round.result.map.submaps[0], world);
  EXPECT_TRUE(comparison);
  return known_by_round(*round.parts, round.parts->parts()[0], comparison->old_from_new, {});
}

TEST(JoinedSystem, OfABuildHasTheMapsOwnPlacesAndCovariances) {
  const BuiltRound build(test::walk_through(a_room(), 60, 0, 60));
  const JoinedMarkers alone = join(known_of(build), {});
  ASSERT_EQ(alone.covariances.size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) {
    const MapMarker& marker = build.result.map.submaps[0].markers[i];
    EXPECT_LT((alone.covariances[i] - marker.covariance).norm(), 1e-3 * marker.covariance.norm());
    EXPECT_LT(alone.known.system.world_from_marker[i].minus(marker.world_from_marker).norm(), 1e-6);
  }
}

TEST(JoinedSystem, OfTwoRoundsIsTheBuildOfBoth) {
  const auto monday = test::walk_through(a_room(), 60, 0, 60);
  const auto tuesday = test::walk_through(a_room(), 50, 0, 20);
  const BuiltRound first(monday);
  const JoinedMarkers joined =
      join(known_of(first), seen_in(BuiltRound(tuesday), first.result.map.submaps[0]));
  auto observations =
      make_observations({test::capture_of(monday), test::capture_of(tuesday, "tuesday")}, {});
  ASSERT_TRUE(observations);
  Progress progress(false);
  const BuildResult both = build_map(Selection(*observations), {}, progress);
  ASSERT_EQ(joined.covariances.size(), 40U);
  SubMap map = first.result.map.submaps[0];
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    map.markers[i].world_from_marker = joined.known.system.world_from_marker[i];
  }
  const auto comparison = compare_frames(map, both.map.submaps[0]);
  ASSERT_TRUE(comparison);
  ASSERT_EQ(comparison->stayed.size(), 40U);
  double off = 0;
  double sigma = 0;
  double ratio = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    const Matrix6d& expected = both.map.submaps[0].markers[i].covariance;
    off += std::pow(comparison->stayed[i].distance_m, 2);
    sigma += expected.topLeftCorner<3, 3>().trace();
    ratio += joined.covariances[i].topLeftCorner<3, 3>().trace() / 40 /
             expected.topLeftCorner<3, 3>().trace();
  }
  EXPECT_LT(std::sqrt(off / sigma), 0.25);
  EXPECT_NEAR(ratio, 1.0, 0.15);
}

TEST(JoinedSystem, ItsSigmasAreThoseOfItsErrors) {
  double sum = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const BuiltRound first(test::walk_through(a_room(seed), 60, 0, 60));
    const JoinedMarkers joined =
        join(known_of(first), seen_in(BuiltRound(test::walk_through(a_room(seed), 50, 0, 15)),
                                      first.result.map.submaps[0]));
    ASSERT_FALSE(joined.covariances.empty());
    const auto& places = joined.known.system.world_from_marker;
    std::vector<Eigen::Vector3d> estimated;
    std::vector<Eigen::Vector3d> truth;
    const auto room = test::make_room(a_room(seed).options).world_from_marker;
    for (std::size_t i = 0; i < places.size(); ++i) {
      estimated.push_back(places[i].translation);
      truth.push_back(room[static_cast<std::size_t>(joined.known.ids[i].number)].translation);
    }
    const auto motion = align_points(truth, estimated, false);
    ASSERT_TRUE(motion);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Eigen::Vector3d off = estimated[i] - *motion * truth[i];
      sum += off.dot(joined.covariances[i].topLeftCorner<3, 3>().inverse() * off) /
             (3.0 * static_cast<double>(places.size()) * 6.0);
    }
  }
  EXPECT_NEAR(sum, 1.0, 0.2);
}

TEST(JoinedSystem, TheMeanOfTheEarlierMarkersStays) {
  const BuiltRound first(test::walk_through(a_room(), 60, 0, 60));
  const JoinedMarkers joined = join(
      known_of(first),
      seen_in(BuiltRound(test::walk_through(a_room(), 50, 0, 20)), first.result.map.submaps[0]));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 40; ++i) {
    mean += joined.known.system.world_from_marker[i].translation -
            first.result.map.submaps[0].markers[i].world_from_marker.translation;
  }
  EXPECT_LT(mean.norm() / 40, 1e-7);
}

TEST(JoinedSystem, AccountsThatShareNoMarkerDetermineNothing) {
  const BuiltRound first(test::walk_through(a_room(), 60, 0, 60));
  const KnownMarkers known = known_of(first);
  std::set<MarkerId> some;
  std::set<MarkerId> others;
  for (int i = 0; i < 40; ++i) (i < 20 ? some : others).insert(id(i));
  EXPECT_TRUE(join(known.marginal(some), known.marginal(others)).covariances.empty());
}

TEST(JoinedSystem, WhatIsKnownSurelyPlacesTheRest) {
  const BuiltRound first(test::walk_through(a_room(), 60, 0, 60));
  SubMap sure = first.result.map.submaps[0];
  sure.markers.resize(20);
  KnownMarkers known;
  for (MapMarker& marker : sure.markers) {
    marker.covariance = 1e-10 * Matrix6d::Identity();
    known.ids.push_back(marker.id);
  }
  known.system = independent_system(sure);
  const JoinedMarkers joined =
      join(known, seen_in(BuiltRound(test::walk_through(a_room(), 50, 0, 50)), sure));
  ASSERT_EQ(joined.known.ids.size(), 40U);
  for (std::size_t i = 0; i < 20; ++i) {
    const Rigid3& place = joined.known.system.world_from_marker[i];
    EXPECT_LT((place.translation - sure.markers[i].world_from_marker.translation).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace waymark
