#include "mapbuilder/diagnosis/diagnosed_build.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/mapbuilder/mapping/room_table.h"

namespace waymark::test {
namespace {

constexpr int kFrameSets = 60;

SyntheticRoom noisy_room() {
  RoomOptions options;
  options.markers = 30;
  options.frame_sets = kFrameSets;
  options.noise_px = 0.1;
  return make_room(options);
}

/// Lets `change` look at every detection: false takes it out.
void edit(SyntheticRoom& room, const std::function<bool(Detection&, Stamp)>& change) {
  for (ImageDetections& image : room.images) {
    std::erase_if(image.detections, [&](Detection& d) { return !change(d, image.stamp); });
  }
}

/// From the stamp on, id `moved` stands where id `stand_in` stood; that one exists no more.
void move(SyntheticRoom& room, int moved, int stand_in, Stamp from) {
  edit(room, [&](Detection& d, Stamp stamp) {
    if (d.marker.number == moved) return stamp < from;
    if (d.marker.number != stand_in) return true;
    d.marker.number = moved;
    return stamp >= from;
  });
}

void state_size(SyntheticRoom& room, int id, double size_m) {
  auto entries = room.catalog.entries();
  entries.front().size_m_by_id[id] = size_m;
  room.catalog = MarkerCatalog(entries);
}

/// Counts how often each id is seen.
int sightings(const SyntheticRoom& room, int id) {
  int count = 0;
  for (const ImageDetections& image : room.images) {
    for (const Detection& d : image.detections) count += d.marker.number == id ? 1 : 0;
  }
  return count;
}

class DiagnosedBuildTest : public ::testing::Test {
 protected:
  void build(std::vector<DetectedCapture> captures) {
    auto table = make_observation_table(std::move(captures), {});
    ASSERT_TRUE(table) << table.error().message;
    table_ = std::move(*table);
    build_ = build_and_diagnose(table_, {}, {}, progress_);
  }
  void build(const SyntheticRoom& room) { build({capture_of(room)}); }

  [[nodiscard]] const MapMarker* mapped(int id) const {
    for (const MapMarker& marker : build_.result.map.submaps.front().markers) {
      if (marker.id.number == id) return &marker;
    }
    return nullptr;
  }

  /// Largest error (m) of mapped distances between markers that are not to be looked at.
  [[nodiscard]] double worst_distance_m(const SyntheticRoom& room,
                                        const std::vector<int>& without) const {
    double worst = 0;
    const auto& markers = build_.result.map.submaps.front().markers;
    const auto skipped = [&](const MapMarker& m) {
      return std::find(without.begin(), without.end(), m.id.number) != without.end();
    };
    for (const MapMarker& a : markers) {
      for (const MapMarker& b : markers) {
        if (skipped(a) || skipped(b)) continue;
        const auto at = [&](const MapMarker& m) {
          return room.world_from_marker[static_cast<std::size_t>(m.id.number)].translation;
        };
        worst = std::max(
            worst,
            std::abs((a.world_from_marker.translation - b.world_from_marker.translation).norm() -
                     (at(a) - at(b)).norm()));
      }
    }
    return worst;
  }

  [[nodiscard]] double figure(const char* name) const {
    for (const Figure& figure : build_.findings.front().figures) {
      if (figure.name == name) return figure.value;
    }
    ADD_FAILURE() << "no figure " << name;
    return 0;
  }

  /// Exactly one finding, of this kind, about this marker.
  void expect_only(FindingKind kind, int id) const {
    ASSERT_EQ(build_.findings.size(), 1u)
        << (build_.findings.empty() ? "" : build_.findings.back().title);
    EXPECT_EQ(build_.findings.front().kind, kind) << build_.findings.front().title;
    ASSERT_EQ(build_.findings.front().markers.size(), 1u);
    EXPECT_EQ(build_.findings.front().markers.front().number, id);
  }

  Progress progress_{false};
  ObservationTable table_;
  DiagnosedBuild build_;
};

TEST_F(DiagnosedBuildTest, namesNobodyInASoundRoom) {
  build(noisy_room());
  EXPECT_TRUE(build_.findings.empty());
}

TEST_F(DiagnosedBuildTest, aWrongSizeIsFittedAndTheRestUnharmed) {
  SyntheticRoom room = noisy_room();
  state_size(room, 7, 0.33);
  build(room);
  expect_only(FindingKind::wrong_size, 7);
  EXPECT_NEAR(figure("stated size"), 0.33, 1e-12);
  EXPECT_NEAR(figure("fitted size"), 0.30, 0.001);
  ASSERT_NE(mapped(7), nullptr);
  EXPECT_NEAR(mapped(7)->size_m, 0.30, 0.001);
  EXPECT_EQ(mapped(7)->stated_size_m, 0.33);
  EXPECT_LT(worst_distance_m(room, {}), 0.01);
}

TEST_F(DiagnosedBuildTest, aSizeWithinThePrintsToleranceIsNotNamed) {
  SyntheticRoom room = noisy_room();
  state_size(room, 7, 0.3 * 1.02);
  build(room);
  EXPECT_TRUE(build_.findings.empty());
}

TEST_F(DiagnosedBuildTest, anIdThatExistsTwiceIsKeptOut) {
  SyntheticRoom room = noisy_room();
  edit(room, [](Detection& d, Stamp) {
    if (d.marker.number == 20) d.marker.number = 3;
    return true;
  });
  build(room);
  expect_only(FindingKind::twin, 3);
  EXPECT_NEAR(
      figure("distance between the places"),
      (room.world_from_marker[3].translation - room.world_from_marker[20].translation).norm(),
      0.02);
  EXPECT_EQ(mapped(3), nullptr);
  EXPECT_LT(worst_distance_m(room, {3}), 0.01);
}

TEST_F(DiagnosedBuildTest, aMarkerMovedDuringTheCaptureKeepsItsLaterPlace) {
  SyntheticRoom room = noisy_room();
  move(room, 3, 4, room_stamp(kFrameSets / 2));
  build(room);
  expect_only(FindingKind::moved_during_capture, 3);
  ASSERT_NE(mapped(3), nullptr);
  EXPECT_EQ(mapped(3)->rejected, 0u);
  room.world_from_marker[3] = room.world_from_marker[4];
  EXPECT_LT(worst_distance_m(room, {}), 0.01);
}

TEST_F(DiagnosedBuildTest, aMarkerMovedBetweenCapturesKeepsItsLaterPlace) {
  const SyntheticRoom before = noisy_room();
  SyntheticRoom after = before;
  constexpr Stamp kHour{3'600'000'000'000};
  for (ImageDetections& image : after.images) image.stamp += kHour;
  move(after, 3, 4, Stamp{0});
  SyntheticRoom first = before;
  edit(first, [](Detection& d, Stamp) { return d.marker.number != 4; });
  build({capture_of(first, "first"), capture_of(after, "second")});
  expect_only(FindingKind::moved_between_captures, 3);
  EXPECT_NEAR(
      figure("distance between the places"),
      (before.world_from_marker[3].translation - before.world_from_marker[4].translation).norm(),
      0.02);
  SyntheticRoom truth = before;
  truth.world_from_marker[3] = before.world_from_marker[4];
  EXPECT_LT(worst_distance_m(truth, {}), 0.01);
}

TEST_F(DiagnosedBuildTest, wrongIdsAreNamedWithTheMarkerTheyShow) {
  SyntheticRoom room = noisy_room();
  int number = 0;
  std::optional<Stamp> misread;
  edit(room, [&](Detection& d, Stamp stamp) {
    if (!misread && d.marker.number == 11 && ++number == 5) {
      d.marker.number = 25;
      misread = stamp;
    }
    return true;
  });
  ASSERT_TRUE(misread);
  build(room);
  expect_only(FindingKind::wrong_id, 25);
  const std::string& evidence = build_.findings.front().evidence;
  EXPECT_NE(evidence.find(std::to_string(misread->count())), std::string::npos) << evidence;
  EXPECT_NE(evidence.find("it is marker 11"), std::string::npos) << evidence;
  ASSERT_NE(mapped(25), nullptr);
  EXPECT_EQ(mapped(25)->rejected, 0u);
}

TEST_F(DiagnosedBuildTest, anIdThatOnlyExistsByMisreadingIsNoMarker) {
  SyntheticRoom room = noisy_room();
  auto entries = room.catalog.entries();
  entries.front().size_m_by_id[200] = 0.3;
  room.catalog = MarkerCatalog(entries);
  int number = 0;
  edit(room, [&](Detection& d, Stamp) {
    if (d.marker.number == 11 && ++number == 5) d.marker.number = 200;
    return true;
  });
  ASSERT_GE(sightings(room, 11), 5);
  build(room);
  expect_only(FindingKind::wrong_id, 200);
  EXPECT_EQ(mapped(200), nullptr);
}

}  // namespace
}  // namespace waymark::test
