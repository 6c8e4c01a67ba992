#include "mapbuilder/upkeep/flipped_markers.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/upkeep/kept_up_room.h"

namespace waymark {
namespace {

using test::BuiltRound;
using test::id;

/// A walk far from small markers, which their corners' noise leaves open to flips.
struct FarWalk {
  FarWalk() {
    today.options.noise_px = 0.6;
    today.options.room_m = 16;
    today.options.marker_m = 0.2;
    today.options.markers = 60;
    round = std::make_unique<BuiltRound>(test::walk_through(today, 40, 0, 3));
    truth = test::make_room(today.options).world_from_marker;
  }

  /// The true places in the round's world.
  [[nodiscard]] std::map<MarkerId, Rigid3> earlier() const {
    SubMap room;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      MapMarker marker;
      marker.id = id(static_cast<int>(i));
      marker.world_from_marker = truth[i];
      marker.covariance = unknown_covariance();
      room.markers.push_back(marker);
    }
    const auto comparison =
        compare_frames(round->parts->submap_of(round->parts->parts()[0]), room, {}, {0.2, 0.2});
    EXPECT_TRUE(comparison);
    std::map<MarkerId, Rigid3> places;
    for (const MapMarker& marker : room.markers) {
      places[marker.id] = comparison->old_from_new.inverse() * marker.world_from_marker;
    }
    return places;
  }

  test::RoomToday today;
  std::unique_ptr<BuiltRound> round;
  std::vector<Rigid3> truth;
};

/// How many markers of the first part are turned by more than 8° against these places.
int turned(const BuiltRound& round, const std::map<MarkerId, Rigid3>& places) {
  int count = 0;
  for (const MapMarker& marker : round.parts->submap_of(round.parts->parts()[0]).markers) {
    const double turn =
        angle_between_rad(marker.world_from_marker.rotation, places.at(marker.id).rotation);
    count += turn > 0.14 ? 1 : 0;
  }
  return count;
}

TEST(FlippedMarkers, StandAsTheyStoodWhereTheViewsLeaveItOpen) {
  const FarWalk walk;
  const auto earlier = walk.earlier();
  const int before = turned(*walk.round, earlier);
  ASSERT_GT(before, 0) << "the walk leaves nothing open";
  const RoundPart& part = walk.round->parts->parts()[0];
  const auto places = unflipped(*walk.round->parts, part, earlier);
  EXPECT_FALSE(places.empty());
  walk.round->parts->place(part, places);
  EXPECT_LT(turned(*walk.round, earlier), before);
}

TEST(FlippedMarkers, WhatIsSeenForSureIsNotTurned) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  const BuiltRound round(test::walk_through(today, 50, 0, 50));
  const RoundPart& part = round.parts->parts()[0];
  std::map<MarkerId, Rigid3> earlier;
  for (const MapMarker& marker : round.parts->submap_of(part).markers) {
    earlier[marker.id] =
        marker.world_from_marker * Rigid3{so3_exp(Eigen::Vector3d(0.7, 0, 0)), {0, 0, 0}};
    earlier[marker.id].translation = marker.world_from_marker.translation;
  }
  EXPECT_TRUE(unflipped(*round.parts, part, earlier).empty());
}

}  // namespace
}  // namespace waymark
