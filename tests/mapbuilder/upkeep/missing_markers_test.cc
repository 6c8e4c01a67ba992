#include "mapbuilder/upkeep/missing_markers.h"

#include <gtest/gtest.h>

#include "tests/mapbuilder/upkeep/kept_up_room.h"

namespace waymark {
namespace {

using test::BuiltRound;
using test::id;

/// What a walk finds missing of a map that has marker `number` at its place in the room.
std::vector<MissingMarker> missing_of(const BuiltRound& round, const test::RoomToday& today,
                                      int number, const Rigid3& moved = {}) {
  const RoundPart& part = round.parts->parts()[0];
  const auto truth = test::make_room(today.options).world_from_marker;
  const MapMarker& beside = round.parts->submap_of(part).markers[0];
  MapMarker marker = beside;
  marker.id = id(number);
  marker.world_from_marker = truth[static_cast<std::size_t>(number)] * moved;
  const Rigid3 round_from_room =
      beside.world_from_marker * truth[static_cast<std::size_t>(beside.id.number)].inverse();
  return find_missing(*round.parts, part, round_from_room, {&marker});
}

TEST(MissingMarkers, AreThoseThatManyLookedForInVain) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  today.gone = {17};
  const BuiltRound round(test::walk_through(today, 50, 0, 50));
  const auto missing = missing_of(round, today, 17);
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].id, id(17));
  EXPECT_GE(missing[0].empty_looks, 4);
}

TEST(MissingMarkers, OneThatIsSeenIsNot) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  const BuiltRound round(test::walk_through(today, 50, 0, 50));
  EXPECT_TRUE(missing_of(round, today, 17).empty());
}

TEST(MissingMarkers, WhereNobodyLooksNothingIsMissing) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  today.gone = {17};
  const BuiltRound round(test::walk_through(today, 50, 0, 50));
  // In a room next door, and on the other side of the wall.
  EXPECT_TRUE(missing_of(round, today, 17, {Eigen::Quaterniond::Identity(), {0, 0, -30}}).empty());
  EXPECT_TRUE(
      missing_of(round, today, 17, {so3_exp(Eigen::Vector3d(0, 3.14, 0)), {0, 0, 0}}).empty());
}

TEST(MissingMarkers, AFewLooksDoNotTell) {
  test::RoomToday today;
  today.options.noise_px = 0.2;
  today.options.cameras = 1;
  today.gone = {17};
  const auto looks_of = [&](int last) {
    const BuiltRound round(test::walk_through(today, 50, 0, last));
    const auto missing = missing_of(round, today, 17);
    return missing.empty() ? 0 : missing[0].empty_looks;
  };
  // Of markers that are missed one time in ten, four empty looks still leave it open.
  for (const int last : {4, 8, 16, 32}) {
    const int looks = looks_of(last);
    EXPECT_TRUE(looks == 0 || looks > 4) << last << " " << looks;
  }
}

}  // namespace
}  // namespace waymark
