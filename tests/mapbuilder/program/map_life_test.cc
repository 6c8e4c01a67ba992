#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/geometry/tum.h"
#include "core/map/map_file.h"
#include "core/map/quarantine.h"
#include "tests/mapbuilder/program/run_program.h"

namespace waymark {
namespace {

using test::run_mapbuilder;

constexpr int kMoved = 5;
constexpr int kWronglySuspected = 11;
constexpr int kNew = 40;

/// A hall mapped last year and walked again today: marker 5 has moved, 40 is new.
class MapLife : public testing::Test {
 protected:
  MapLife() {
    test::RoomOptions options;
    options.noise_px = 0.2;
    auto then = test::make_room(options);
    for (ImageDetections& image : then.images) {
      std::erase_if(image.detections, [](const Detection& d) { return d.marker.number == 39; });
    }
    test::write_capture(then, path("then"));
    options.seed = 1;
    options.frame_sets = 50;
    auto now = test::make_room(options);
    for (ImageDetections& image : now.images) {
      for (Detection& d : image.detections) {
        if (d.marker.number == 39) d.marker.number = kNew;
        // Where 5 hung hangs another now, and 5 in place of 7.
        if (d.marker.number == kMoved) {
          d.marker.number = 50;
        } else if (d.marker.number == 7) {
          d.marker.number = kMoved;
        }
      }
    }
    test::write_capture(now, path("now"));
    built = run_mapbuilder({"build", path("then"), "-o", path("then.map")});
  }

  [[nodiscard]] std::string path(const char* name) const { return (folder.path() / name).string(); }

  [[nodiscard]] std::string hash() const { return content_hash(*read_map_file(path("then.map"))); }

  void write_quarantine_of(const std::string& map_hash) const {
    const auto id = [](int number) { return MarkerId{Family::tag36h11, number}; };
    ASSERT_TRUE(write_quarantine(path("quarantine.json"),
                                 {map_hash,
                                  {{id(kMoved), QuarantineState::moved, 1, 3.1},
                                   {id(kWronglySuspected), QuarantineState::moved, 1, 0.05},
                                   {id(kNew), QuarantineState::unknown, 1, 0}}}));
  }

  test::TemporaryFolder folder;
  test::ProgramRun built;
};

TEST_F(MapLife, AQuarantineIsConfirmedAndRefuted) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  write_quarantine_of(hash());
  const auto run =
      run_mapbuilder({"build", path("now"), "-o", path("now.map"), "--frame-of", path("then.map"),
                      "--quarantine", path("quarantine.json"), "--report", path("report")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = nlohmann::json::parse(folder.read("report/summary.json"));
  const auto named = [&](const char* text) {
    std::vector<int> markers;
    for (const auto& finding : summary.at("findings")) {
      if (finding.at("cause") != "moved") continue;
      if (finding.at("text").get<std::string>().find(text) == std::string::npos) continue;
      for (const auto& marker : finding.at("markers")) markers.push_back(marker.get<int>());
    }
    return markers;
  };
  EXPECT_EQ(named("stands where it stood"), std::vector<int>{kWronglySuspected});
  EXPECT_EQ(named("elsewhere than in the earlier map"), std::vector<int>{kMoved});
  EXPECT_EQ(named("the vehicle was right"), std::vector<int>{kMoved});
  EXPECT_EQ(named("nothing tells whether"), std::vector<int>{});
  // The world is the earlier map's.
  const auto then = read_map_file(path("then.map"));
  const auto now = read_map_file(path("now.map"));
  ASSERT_TRUE(then && now);
  const auto& first = then->submaps[0].markers[20].world_from_marker;
  for (const MapMarker& marker : now->submaps[0].markers) {
    if (marker.id != then->submaps[0].markers[20].id) continue;
    EXPECT_LT((marker.world_from_marker.translation - first.translation).norm(), 0.01);
  }
}

TEST_F(MapLife, AQuarantineOfAnotherMapIsRefusedPlainly) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  write_quarantine_of("00000000000000ff");
  const auto build = run_mapbuilder({"build", path("now"), "-o", path("now.map"), "--frame-of",
                                     path("then.map"), "--quarantine", path("quarantine.json")});
  EXPECT_EQ(build.exit_code, 65);
  EXPECT_EQ(test::error_lines(build), 1) << build.err;
  EXPECT_NE(build.err.find("belongs to map 00000000000000ff"), std::string::npos) << build.err;
  EXPECT_FALSE(std::filesystem::exists(path("now.map")));
  const auto localize =
      run_mapbuilder({"localize", path("now"), "--map", path("then.map"), "--trajectory",
                      path("now.tum"), "--quarantine", path("quarantine.json")});
  EXPECT_EQ(localize.exit_code, 65);
  EXPECT_FALSE(std::filesystem::exists(path("now.tum")));
  folder.write("quarantine.json", "{}");
  EXPECT_EQ(run_mapbuilder({"build", path("now"), "-o", path("now.map"), "--quarantine",
                            path("quarantine.json")})
                .exit_code,
            65);
}

TEST_F(MapLife, LocalizingLeavesWhatTheVehicleFoundMovedOut) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  write_quarantine_of(hash());
  const auto run =
      run_mapbuilder({"localize", path("now"), "--map", path("then.map"), "--trajectory",
                      path("now.tum"), "--quarantine", path("quarantine.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("2 markers left out, the vehicle found them moved or ignores them: 5, 11"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(read_tum(path("now.tum"))->size(), 50U);
}

TEST_F(MapLife, ALevelledMapSaysThatItsZIsUpAndARebuildInItsFrameToo) {
  const auto run =
      run_mapbuilder({"build", path("then"), "-o", path("level.map"), "--level", "walls"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto map = read_map_file(path("level.map"));
  ASSERT_TRUE(map);
  EXPECT_TRUE(map->submaps[0].z_is_up);
  EXPECT_FALSE(read_map_file(path("then.map"))->submaps[0].z_is_up);
  ASSERT_EQ(
      run_mapbuilder({"build", path("now"), "-o", path("now.map"), "--frame-of", path("level.map")})
          .exit_code,
      0);
  EXPECT_TRUE(read_map_file(path("now.map"))->submaps[0].z_is_up);
  const auto info = run_mapbuilder({"info", path("level.map")});
  EXPECT_NE(info.out.find("z is up"), std::string::npos) << info.out;
}

TEST_F(MapLife, TwoDaysInOneBuildHaveATrajectoryEach) {
  const auto run = run_mapbuilder({"build", path("then"), path("now"), "-o", path("both.map"),
                                   "--trajectory", path("both.tum")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_tum(path("both.tum"))->size(), 60U);
  EXPECT_EQ(read_tum(path("both.capture1.tum"))->size(), 50U);
  const auto swapped = run_mapbuilder({"build", path("now"), path("then"), "-o",
                                       path("swapped.map"), "--trajectory", path("swapped.tum")});
  ASSERT_EQ(swapped.exit_code, 0) << swapped.err;
  EXPECT_EQ(folder.read("swapped.map"), folder.read("both.map"));
  EXPECT_EQ(folder.read("swapped.tum"), folder.read("both.capture1.tum"));
}

TEST(MeasuredByHand, TheExampleInTheDocumentsIsAMap) {
  const test::TemporaryFolder folder;
  const auto map = (folder.path() / "hall.map").string();
  const auto run = run_mapbuilder({"import", WAYMARK_MEASURED_BY_HAND, "-o", map});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto info = run_mapbuilder({"info", map});
  EXPECT_NE(info.out.find("facility, z is up"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("8.66 mm at most"), std::string::npos) << info.out;
}

TEST_F(MapLife, WhatAnEarlierMapsWorldMovesBeyondAThousandKilometresIsNoMap) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  // The earlier map's world ends in the middle of the hall.
  auto far = *read_map_file(path("then.map"));
  std::vector<MapMarker>& markers = far.submaps[0].markers;
  std::vector<double> x_m;
  for (const MapMarker& m : markers) x_m.push_back(m.world_from_marker.translation.x());
  std::sort(x_m.begin(), x_m.end());
  const double middle_m = x_m[x_m.size() / 2];
  for (MapMarker& m : markers) m.world_from_marker.translation.x() += 1e6 - middle_m;
  std::erase_if(markers, [](const MapMarker& m) {
    return std::abs(m.world_from_marker.translation.x()) > 1e6;
  });
  ASSERT_TRUE(write_map_file(path("far.map"), far));
  for (const bool with_report : {false, true}) {
    std::vector<std::string> arguments{"build",       path("then"), "-o",
                                       path("x.map"), "--frame-of", path("far.map")};
    if (with_report) arguments.insert(arguments.end(), {"--report", path("report")});
    const auto run = run_mapbuilder(arguments);
    EXPECT_EQ(run.exit_code, 65) << run.err;
    EXPECT_EQ(test::error_lines(run), 1) << run.err;
    EXPECT_NE(run.err.find("beyond 1000 km"), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("x.map")));
    EXPECT_FALSE(std::filesystem::exists(path("report")));
  }
}

}  // namespace
}  // namespace waymark
