#include "mapbuilder/diagnosis/place_history.h"
#include "tests/mapbuilder/diagnosis/diagnosed_room.h"

namespace waymark::test {
namespace {

bool always(Stamp /*stamp*/) { return true; }

class PlacesTest : public DiagnosedRoom {};

TEST_F(PlacesTest, anIdThatExistsTwiceIsKeptOut) {
  SyntheticRoom room = noisy_room();
  edit(room, [](Detection& d, Stamp) {
    if (d.marker.number == 20) d.marker.number = 3;
    return true;
  });
  build(room);
  expect_only(Cause::twin, 3);
  EXPECT_NEAR(
      figure("distance between the places"),
      (room.world_from_marker[3].translation - room.world_from_marker[20].translation).norm(),
      0.02);
  EXPECT_EQ(mapped(3), nullptr);
  EXPECT_LT(worst_distance_m(room, {3}), 0.01);
}

TEST_F(PlacesTest, twinsSideBySideAreNamed) {
  SyntheticRoom room = noisy_room();
  hang(room, 3, shifted(room.world_from_marker[3], 0.33, 0), 0.3, always);
  build(room);
  expect_only(Cause::twin, 3);
}

TEST_F(PlacesTest, whatAppearsWhereTheMarkersOwnPrintHangsIsNoTwin) {
  SyntheticRoom room = noisy_room();
  // Every tenth frame set sees it a third of a side off.
  const Rigid3 home = room.world_from_marker[3];
  const auto now_and_then = [](Stamp stamp) {
    return (stamp - room_stamp(0)) / (room_stamp(1) - room_stamp(0)) % 10 == 4;
  };
  edit(room,
       [&](Detection& d, Stamp stamp) { return d.marker.number != 3 || !now_and_then(stamp); });
  hang(room, 3, shifted(home, 0.1, 0), 0.3, now_and_then);
  build(room);
  expect_nobody();
  EXPECT_NE(mapped(3), nullptr);
}

TEST_F(PlacesTest, whatFewOfManyLooksSeeIsNoTwin) {
  SyntheticRoom room = noisy_room();
  const Rigid3 elsewhere = shifted(room.world_from_marker[3], 0.5, 0.1);
  int shown = 0;
  hang(room, 3, elsewhere, 0.3, [&](Stamp stamp) {
    // Four frame sets along the walk; the other ones that look there see nothing.
    shown += 1;
    const auto set = (stamp - room_stamp(0)) / (room_stamp(1) - room_stamp(0));
    return set == 9 || set == 22 || set == 36 || set == 50;
  });
  ASSERT_GT(shown, 0);
  build(room);
  for (const Finding& finding : build_.findings) {
    EXPECT_EQ(finding.cause, Cause::wrong_id) << titles();
  }
  EXPECT_NE(mapped(3), nullptr);
}

TEST_F(PlacesTest, aMarkerMovedDuringTheCaptureKeepsItsLaterPlace) {
  SyntheticRoom room = noisy_room();
  const Stamp moved_at = room_stamp(kFrameSets / 2);
  const Rigid3 before = room.world_from_marker[3];
  room.world_from_marker[3] = shifted(before, 0.2, 0.1);
  edit(room, [&](Detection& d, Stamp stamp) { return d.marker.number != 3 || stamp < moved_at; });
  hang(room, 3, room.world_from_marker[3], 0.3, [&](Stamp stamp) { return stamp >= moved_at; });
  build(room);
  expect_only(Cause::moved, 3);
  EXPECT_NE(titles().find("during a capture"), std::string::npos);
  EXPECT_NEAR(figure("distance between the places"), std::hypot(0.2, 0.1), 0.005);
  ASSERT_NE(mapped(3), nullptr);
  EXPECT_LT(worst_distance_m(room, {}), 0.01);
}

TEST_F(PlacesTest, aMarkerMovedBetweenCapturesKeepsItsLaterPlace) {
  const SyntheticRoom first = noisy_room();
  SyntheticRoom second = first;
  second.world_from_marker[3] = shifted(first.world_from_marker[3], -0.25, 0.0, 0.3);
  take_down(second, 3);
  hang(second, 3, second.world_from_marker[3], 0.3, always);
  build({capture_of(first, "first"), capture_of(an_hour_later(second), "second")});
  expect_only(Cause::moved, 3);
  EXPECT_NE(titles().find("between captures"), std::string::npos);
  EXPECT_LT(worst_distance_m(second, {}), 0.01);
}

TEST_F(PlacesTest, aMarkerMovedBetweenCapturesWhoseClocksTellNoOrderIsKeptOut) {
  const SyntheticRoom first = noisy_room();
  SyntheticRoom second = first;
  second.world_from_marker[3] = shifted(first.world_from_marker[3], -0.25, 0.0, 0.3);
  take_down(second, 3);
  hang(second, 3, second.world_from_marker[3], 0.3, always);
  DetectedCapture before = capture_of(first, "first");
  DetectedCapture after = capture_of(an_hour_later(second), "second");
  before.monotonic = after.monotonic = true;
  build({before, after});
  expect_only(Cause::moved, 3);
  EXPECT_NE(titles().find("between captures"), std::string::npos);
  EXPECT_EQ(mapped(3), nullptr);
}

TEST_F(PlacesTest, newAndGoneMarkersAreNamedBetweenCaptures) {
  SyntheticRoom first = noisy_room();
  SyntheticRoom second = first;
  take_down(first, 5);
  take_down(second, 8);
  build({capture_of(first, "first"), capture_of(an_hour_later(second), "second")});
  ASSERT_EQ(build_.findings.size(), 2u) << titles();
  EXPECT_EQ(build_.findings[0].cause, Cause::moved);
  EXPECT_EQ(build_.findings[0].text.rfind("is new", 0), 0U);
  EXPECT_EQ(build_.findings[0].markers.front().number, 5);
  EXPECT_EQ(build_.findings[1].cause, Cause::moved);
  EXPECT_EQ(build_.findings[1].text.rfind("is gone", 0), 0U);
  EXPECT_EQ(build_.findings[1].markers.front().number, 8);
}

TEST_F(PlacesTest, twoSoundCapturesNameNobody) {
  RoomOptions options;
  options.markers = 30;
  options.noise_px = 0.1;
  options.frame_sets = 60;
  SyntheticRoom second = make_room(options);
  // The second walk sees but half of the room.
  edit(second, [&](Detection&, Stamp stamp) { return stamp < room_stamp(30); });
  build({capture_of(noisy_room(), "first"), capture_of(an_hour_later(second), "second")});
  expect_nobody();
}

}  // namespace
}  // namespace waymark::test
