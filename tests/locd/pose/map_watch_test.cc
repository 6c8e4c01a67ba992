#include "locd/pose/map_watch.h"

#include <gtest/gtest.h>

#include "tests/locd/pose/room_drive.h"
#include "tests/support/expect_ranges.h"
#include "tests/support/small_map.h"

namespace waymark {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

/// A room seen by so many cameras that are all in the same place.
test::SyntheticRoom room_seen_by(int cameras) {
  test::RoomOptions options;
  options.frame_sets = 150;
  options.noise_px = 0.1;
  options.state_covariances = true;
  options.turn_in_place_rad = 0.3;
  options.cameras = 1;
  test::SyntheticRoom room = test::make_room(options);
  const RigCamera camera = room.rig.cameras[0];
  const std::vector<ImageDetections> images = room.images;
  room.rig.cameras.assign(static_cast<std::size_t>(cameras), camera);
  room.images.clear();
  for (std::size_t c = 0; c < room.rig.cameras.size(); ++c) {
    room.rig.cameras[c].name = "cam" + std::to_string(c);
  }
  for (ImageDetections image : images) {
    for (image.camera = 0; image.camera < cameras; ++image.camera) room.images.push_back(image);
  }
  return room;
}

/// The marker that is in view from the first set to the last, near the middle.
MarkerId marker_in_view(const test::SyntheticRoom& room) {
  std::map<MarkerId, std::size_t> seen;
  for (const ImageDetections& image : room.images) {
    for (const Detection& detection : image.detections) ++seen[detection.marker];
  }
  return std::max_element(seen.begin(), seen.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

class MapWatchOfCameras : public testing::TestWithParam<int> {
 protected:
  /// The set in which the first alert comes; −1: none does. Of a map in which the marker hangs
  /// `off_m` away, and which distrusts it from the start or not.
  static int first_alert(int cameras, double off_m, bool quarantined, bool raised) {
    test::RoomDrive drive(room_seen_by(cameras));
    const MarkerId marker = marker_in_view(drive.room());
    MarkerMap map = test::room_map(drive.room());
    MapMarker& mapped = map.submaps[0].markers[static_cast<std::size_t>(marker.number)];
    mapped.world_from_marker.translation.z() += off_m;
    Localizer localizer(drive.room().rig, map, {});
    const QuarantinedMarker known{marker, QuarantineState::moved, 0, 0.3};
    if (quarantined) localizer.restore_quarantine(std::span(&known, 1));
    PoseEstimate estimate;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      localizer.localize(drive.set(i), estimate);
      for (const Alert& alert : localizer.alerts()) {
        EXPECT_EQ(alert.kind, AlertKind::marker_moved);
        EXPECT_EQ(alert.marker, marker);
        EXPECT_EQ(alert.raised, raised);
        return static_cast<int>(i);
      }
    }
    return -1;
  }
};

TEST_P(MapWatchOfCameras, CondemnAMarkerAfterTheSameSetsHoweverMany) {
  const int by_one = first_alert(1, 0.3, false, true);
  EXPECT_GE(by_one, MapWatchOptions{}.sets_elsewhere - 1);
  EXPECT_EQ(first_alert(GetParam(), 0.3, false, true), by_one);
}

TEST_P(MapWatchOfCameras, TakeAMarkerBackAfterAsManySetsHoweverMany) {
  const int by_one = first_alert(1, 0.0, true, false);
  EXPECT_GE(by_one, MapWatchOptions{}.sets_back - 1);
  // Evidence of several may tell sooner, never from fewer sets than that.
  const int by_several = first_alert(GetParam(), 0.0, true, false);
  EXPECT_GE(by_several, MapWatchOptions{}.sets_back - 1);
  EXPECT_LE(by_several, by_one);
}

INSTANTIATE_TEST_SUITE_P(MapWatch, MapWatchOfCameras, testing::Values(2, 3, 4));

/// A watch that hears of ids which the map lacks.
class UnmappedMarkers : public testing::Test {
 protected:
  void see(Stamp at) {
    alerts_.clear();
    watch_.note_unknown(at, marker_, alerts_);
    watch_.forget_unknown(at, alerts_);
  }
  /// Seen so often in a row, ten times a second; how many alerts that gives.
  int see_often(Stamp from, int sets) {
    int given = 0;
    for (int i = 0; i < sets; ++i) {
      see(from + i * milliseconds(100));
      given += static_cast<int>(alerts_.size());
    }
    return given;
  }
  [[nodiscard]] std::size_t listed() {
    std::vector<QuarantinedMarker> list;
    watch_.list_quarantine(list);
    return list.size();
  }

  const MarkerId marker_{Family::tag36h11, 99};
  const MarkerMap map_ = test::small_map();
  MapIndex index_{map_};
  RigPoseSolver solver_{test::ring_rig(2), {}};
  MapWatch watch_{index_, solver_};
  std::vector<Alert> alerts_;
};

TEST_F(UnmappedMarkers, AreNamedOnceWhenTheyAreSeenAgainAndAgain) {
  EXPECT_EQ(see_often(hours(1), MapWatchOptions{}.sets_unknown - 1), 0);
  EXPECT_EQ(see_often(hours(1) + seconds(2), 50), 1);
  EXPECT_EQ(listed(), 1U);
}

TEST_F(UnmappedMarkers, ThatAreMisreadingsNowAndThenAreNeverNamed) {
  for (const Stamp apart : {Stamp(seconds(10)), Stamp(minutes(1)), Stamp(hours(24 * 30))}) {
    for (int i = 0; i < 100; ++i) {
      see(hours(1) + i * apart);
      EXPECT_TRUE(alerts_.empty()) << i << " times, " << apart.count() << " ns apart";
    }
  }
  EXPECT_EQ(listed(), 0U);
  EXPECT_FALSE(watch_.changed());
}

TEST_F(UnmappedMarkers, MisreadInBurstsThatAreFarApartAreNotNamedEither) {
  for (int burst = 0; burst < 50; ++burst) {
    EXPECT_EQ(see_often(hours(1) + burst * minutes(5), 5), 0);
  }
}

TEST_F(UnmappedMarkers, ThatAreGoneForAnHourAreSaidToBeAndMayComeBack) {
  EXPECT_EQ(see_often(hours(1), 20), 1);
  const auto look = [&](Stamp at) {
    alerts_.clear();
    watch_.forget_unknown(at, alerts_);
    return alerts_.size();
  };
  EXPECT_EQ(look(hours(1) + minutes(59)), 0U);
  EXPECT_EQ(listed(), 1U);
  ASSERT_EQ(look(hours(2) + seconds(3)), 1U);
  EXPECT_FALSE(alerts_[0].raised);
  EXPECT_EQ(alerts_[0].marker, marker_);
  EXPECT_TRUE(watch_.changed());
  EXPECT_EQ(listed(), 0U);
  EXPECT_EQ(look(hours(4)), 0U);
  EXPECT_EQ(see_often(hours(5), 20), 1);
}

TEST_F(UnmappedMarkers, KnownFromBeforeARestartAreGoneAnHourAfterIt) {
  const QuarantinedMarker known{marker_, QuarantineState::unknown, 0, 0};
  watch_.restore(std::span(&known, 1));
  EXPECT_EQ(listed(), 1U);
  watch_.forget_unknown(hours(500), alerts_);
  EXPECT_TRUE(alerts_.empty());
  watch_.forget_unknown(hours(502), alerts_);
  EXPECT_EQ(alerts_.size(), 1U);
}

TEST_F(UnmappedMarkers, AreReleasedAndMayBeNamedAgain) {
  EXPECT_FALSE(watch_.release(hours(1), marker_, alerts_));
  EXPECT_EQ(see_often(hours(1), 20), 1);
  alerts_.clear();
  EXPECT_TRUE(watch_.release(hours(1) + seconds(3), marker_, alerts_));
  ASSERT_EQ(alerts_.size(), 1U);
  EXPECT_FALSE(alerts_[0].raised);
  EXPECT_EQ(listed(), 0U);
  EXPECT_EQ(see_often(hours(1) + seconds(4), 20), 1);
}

TEST(MapWatchOptions, AreHeldToTheirRanges) {
  using Options = MapWatchOptions;
  expect_ranges<Options>({ranged("min_other_markers", &Options::min_other_markers, {2, 20}),
                          ranged("sets_elsewhere", &Options::sets_elsewhere, {2, 100}),
                          ranged("sets_back", &Options::sets_back, {2, 1000}),
                          ranged("sets_unknown", &Options::sets_unknown, {2, 1000}),
                          ranged("unknown_memory in s", &Options::unknown_memory, {1, 3600}, 1e6),
                          ranged("unknown_gone in s", &Options::unknown_gone, {60, 86'400}, 1e6)});
}

}  // namespace
}  // namespace waymark
