#include "mapbuilder/upkeep/prior_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mapbuilder/upkeep/kept_up_room.h"

namespace waymark {
namespace {

using test::BuiltRound;
using test::id;

/// The room's own places as a map that is `sigma_m` sure of each.
std::vector<MapMarker> true_map(const test::RoomToday& today, double sigma_m) {
  std::vector<MapMarker> markers;
  int number = 0;
  for (const Rigid3& place : test::make_room(today.options).world_from_marker) {
    MapMarker marker;
    marker.id = id(number++);
    marker.world_from_marker = place;
    marker.covariance = sigma_m * sigma_m * Matrix6d::Identity();
    markers.push_back(marker);
  }
  return markers;
}

std::vector<const MapMarker*> first_of(const std::vector<MapMarker>& markers, std::size_t count) {
  std::vector<const MapMarker*> known;
  for (std::size_t i = 0; i < count; ++i) known.push_back(&markers[i]);
  return known;
}

Rigid3 room_from_round(const BuiltRound& round, const std::vector<MapMarker>& truth) {
  const MapMarker& first = round.result.submaps[0].map.markers[0];
  return truth[static_cast<std::size_t>(first.id.number)].world_from_marker *
         first.world_from_marker.inverse();
}

TEST(PriorAdjustment, WhatIsKnownSurelyStaysAndPlacesTheRest) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  const auto truth = true_map(today, 1e-5);
  const BuiltRound round(test::walk_through(today, 50, 0, 50));
  const auto places = adjust_with_priors(*round.parts, round.parts->parts()[0],
                                         room_from_round(round, truth), first_of(truth, 20));
  ASSERT_EQ(places.size(), 40U);
  for (const MapMarker& marker : truth) {
    const AdjustedPlace& place = places.at(marker.id);
    const double off_m =
        (place.world_from_marker.translation - marker.world_from_marker.translation).norm();
    EXPECT_LT(off_m, marker.id.number < 20 ? 1e-4 : 0.004) << marker.id.number;
    const double sigma_m = std::sqrt(place.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_LT(sigma_m, marker.id.number < 20 ? 2e-5 : 0.003);
  }
}

TEST(PriorAdjustment, ItsSigmasAreThoseOfItsErrors) {
  double sum = 0;
  int freedoms = 0;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    test::RoomToday today;
    today.options.noise_px = 0.3;
    today.options.seed = seed;
    const auto truth = true_map(today, 1e-5);
    const BuiltRound round(test::walk_through(today, 40, 0, 40));
    const auto places = adjust_with_priors(*round.parts, round.parts->parts()[0],
                                           room_from_round(round, truth), first_of(truth, 12));
    for (const auto& [marker, place] : places) {
      if (marker.number < 12) continue;
      const Vector6d off = place.world_from_marker.minus(
          truth[static_cast<std::size_t>(marker.number)].world_from_marker);
      sum += off.dot(place.covariance.inverse() * off);
      freedoms += 6;
    }
  }
  EXPECT_NEAR(sum / freedoms, 1.0, 0.2);
}

TEST(PriorAdjustment, WithoutAnythingKnownThereIsNoWorld) {
  test::RoomToday today;
  const BuiltRound round(test::walk_through(today, 50, 0, 20));
  EXPECT_TRUE(adjust_with_priors(*round.parts, round.parts->parts()[0], {}, {}).empty());
}

}  // namespace
}  // namespace waymark
