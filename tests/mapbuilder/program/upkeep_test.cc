#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/map/map_file.h"
#include "core/map/marker_search.h"
#include "core/map/quarantine.h"
#include "tests/mapbuilder/program/run_program.h"
#include "tests/support/small_map.h"

namespace waymark {
namespace {

using test::run_mapbuilder;

/// A map in a file, kept up as its owner does.
class Upkeep : public testing::Test {
 protected:
  Upkeep() { EXPECT_TRUE(write_map_file(path("hall.map"), test::small_map())); }

  [[nodiscard]] std::string path(const char* name) const { return (folder.path() / name).string(); }

  test::TemporaryFolder folder;
};

TEST_F(Upkeep, ADistanceIsAskedForBeforeOrBehindTheMap) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"info", path("hall.map"), "--distance", "3", "586"},
           {"info", "--distance", "3", "586", path("hall.map")}}) {
    const auto run = run_mapbuilder(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.out.rfind("distance     4.582576 m", 0), 0U) << run.out;
  }
  const auto absent = run_mapbuilder({"info", path("hall.map"), "--distance", "3", "99"});
  EXPECT_EQ(absent.exit_code, 65);
  EXPECT_EQ(test::error_lines(absent), 1) << absent.err;
  EXPECT_EQ(run_mapbuilder({"info", path("hall.map"), "--distance", "3"}).exit_code, 64);
}

TEST_F(Upkeep, AnEditInPlaceIsWhatDiffNames) {
  const auto edited = run_mapbuilder({"edit", path("hall.map"), "-o", path("new.map"), "--remove",
                                      "0", "--rename", "12=120,3=30", "--accept", "586"});
  ASSERT_EQ(edited.exit_code, 0) << edited.err;
  const auto diff = run_mapbuilder({"diff", path("hall.map"), path("new.map"), "--json"});
  ASSERT_EQ(diff.exit_code, 0) << diff.err;
  const auto json = nlohmann::json::parse(diff.out);
  EXPECT_EQ(json["verified"], nlohmann::json({586}));
  EXPECT_EQ(json["vanished"][0], 0);
  const auto in_place =
      run_mapbuilder({"edit", path("new.map"), "-o", path("new.map"), "--rename", "120=12"});
  ASSERT_EQ(in_place.exit_code, 0) << in_place.err;
  EXPECT_EQ(marker_ids(*read_map_file(path("new.map"))).size(), 4U);
}

TEST_F(Upkeep, ARefusedEditLeavesWhatStoodThere) {
  const std::string before = folder.read("hall.map");
  for (const auto& [option, ids] : std::vector<std::pair<std::string, std::string>>{
           {"--remove", "9"}, {"--remove", "0,3,7,12,586"}, {"--rename", "3=7"}}) {
    const auto run =
        run_mapbuilder({"edit", path("hall.map"), "-o", path("hall.map"), option, ids});
    EXPECT_EQ(run.exit_code, 65) << run.err;
    EXPECT_EQ(test::error_lines(run), 1) << run.err;
    EXPECT_EQ(folder.read("hall.map"), before);
  }
  // A disk that is full.
  const auto full =
      run_mapbuilder({"edit", path("hall.map"), "-o", path("hall.map"), "--remove", "3"}, 1000);
  EXPECT_EQ(full.exit_code, 74) << full.err;
  EXPECT_EQ(folder.read("hall.map"), before);
}

TEST_F(Upkeep, OneMapIsTheSameMap) {
  const auto diff = run_mapbuilder({"diff", path("hall.map"), path("hall.map")});
  EXPECT_EQ(diff.exit_code, 0) << diff.err;
  EXPECT_EQ(diff.out.rfind("the same map: ", 0), 0U) << diff.out;
  EXPECT_EQ(run_mapbuilder({"diff", path("hall.map"), path("absent.map")}).exit_code, 66);
}

MarkerId id(int number) { return {Family::tag36h11, number}; }

/// A hall that was mapped, and a round through it on a later day: 7 hangs where 5 hung, 39 is gone,
/// 40 has come.
class Update : public testing::Test {
 protected:
  Update() {
    test::RoomOptions options;
    options.noise_px = 0.2;
    auto then = test::make_room(options);
    test::write_capture(then, path("then"));
    options.frame_sets = 50;
    auto now = test::make_room(options);
    const Rigid3 place = now.world_from_marker[5];
    for (ImageDetections& image : now.images) {
      std::erase_if(image.detections, [](const Detection& d) {
        return d.marker.number == 5 || d.marker.number == 7 || d.marker.number == 39;
      });
    }
    test::hang(now, 7, place, options.marker_m, [](Stamp) { return true; });
    test::hang(now, 40,
               now.world_from_marker[5] * Rigid3{Eigen::Quaterniond::Identity(), {0.6, 0, 0}},
               options.marker_m, [](Stamp) { return true; });
    test::write_capture(now, path("now"));
    built = run_mapbuilder({"build", path("then"), "-o", path("old.map")});
  }

  [[nodiscard]] std::string path(const char* name) const { return (folder.path() / name).string(); }

  [[nodiscard]] test::ProgramRun update(std::vector<std::string> more) const {
    more.insert(more.begin(), {"update", path("old.map"), path("now"), "-o", path("new.map")});
    return run_mapbuilder(more);
  }

  test::TemporaryFolder folder;
  test::ProgramRun built;
};

TEST_F(Update, NamesWhatHasChangedAndWritesTheMap) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  const auto run = update({"--report", path("report")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("1 moved, 1 new, 2 not where they should be"), std::string::npos)
      << run.out;
  EXPECT_EQ(run.err.find("taken as independent"), std::string::npos) << run.err;
  const auto map = read_map_file(path("new.map"));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->submaps[0].markers.size(), 41U);
  EXPECT_FALSE(find_marker(map->submaps[0], id(39))->verified);
  EXPECT_EQ(map->capture_fingerprints.size(), 2U);
  const auto summary = nlohmann::json::parse(folder.read("report/summary.json"));
  int missing = 0;
  for (const auto& finding : summary.at("findings")) {
    missing += finding.at("text").get<std::string>().rfind("not seen where", 0) == 0 ? 1 : 0;
  }
  EXPECT_EQ(missing, 2);
  const auto diff = run_mapbuilder({"diff", path("old.map"), path("new.map"), "--json"});
  const auto json = nlohmann::json::parse(diff.out);
  EXPECT_EQ(json["appeared"], nlohmann::json({40}));
  EXPECT_EQ(json["vanished"], nlohmann::json::array());
  EXPECT_LT(json["submaps"][0]["world_shift_m"].get<double>(), 0.001);
}

TEST_F(Update, WhatIsMissingLeavesByDropUnseenAlone) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  const auto run = update({"--drop-unseen"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto map = read_map_file(path("new.map"));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->submaps[0].markers.size(), 39U);
  EXPECT_EQ(find_marker(map->submaps[0], id(5)), nullptr);
  EXPECT_EQ(find_marker(map->submaps[0], id(39)), nullptr);
}

TEST_F(Update, AQuarantineIsConfirmedAndRefuted) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  const auto write = [&](const std::string& hash) {
    ASSERT_TRUE(
        write_quarantine(path("quarantine.json"), {hash,
                                                   {{id(7), QuarantineState::moved, 1, 2.9},
                                                    {id(11), QuarantineState::moved, 1, 0.05},
                                                    {id(40), QuarantineState::unknown, 1, 0}}}));
  };
  write(content_hash(*read_map_file(path("old.map"))));
  const auto run = update({"--quarantine", path("quarantine.json"), "--report", path("report")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string summary = folder.read("report/summary.json");
  EXPECT_NE(summary.find("the vehicle was right"), std::string::npos);
  EXPECT_NE(summary.find("stands where it stood"), std::string::npos);
  EXPECT_NE(summary.find("unknown to the vehicle, mapped now"), std::string::npos);
  write("00000000000000ff");
  EXPECT_EQ(update({"--quarantine", path("quarantine.json")}).exit_code, 65);
}

TEST_F(Update, WhateverFailsLeavesWhatStoodThere) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  folder.write("new.map", "what stood there");
  const auto strict = update({"--strict"});
  EXPECT_EQ(strict.exit_code, 65) << strict.err;
  EXPECT_NE(strict.err.find("errors stand against it"), std::string::npos) << strict.err;
  EXPECT_TRUE(read_map_file(path("new.map.rejected")));
  const auto twice =
      run_mapbuilder({"update", path("old.map"), path("then"), "-o", path("new.map")});
  EXPECT_EQ(twice.exit_code, 65);
  EXPECT_NE(twice.err.find("count twice"), std::string::npos) << twice.err;
  test::RoomOptions other;
  other.seed = 9;
  other.room_m = 12;
  test::write_capture(test::make_room(other), path("elsewhere"));
  const auto place =
      run_mapbuilder({"update", path("old.map"), path("elsewhere"), "-o", path("new.map")});
  EXPECT_EQ(place.exit_code, 65) << place.err;
  EXPECT_NE(place.err.find("[other_place]"), std::string::npos) << place.err;
  EXPECT_EQ(run_mapbuilder({"update", path("old.map"), "-o", path("new.map")}).exit_code, 64);
  EXPECT_EQ(run_mapbuilder({"update", path("x.map"), path("now"), "-o", path("new.map")}).exit_code,
            66);
  EXPECT_EQ(
      run_mapbuilder({"update", path("old.map"), path("now"), "-o", path("now/detections.csv")})
          .exit_code,
      64);
  EXPECT_EQ(folder.read("new.map"), "what stood there");
}

TEST_F(Update, SaysWhereNothingIsKnownOfTheMarkersTogether) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  ASSERT_EQ(update({}).exit_code, 0);
  const std::string with_info = folder.read("new.map");
  EXPECT_TRUE(std::filesystem::exists(path("new.map.info")));
  folder.write("old.map.info", folder.read("old.map.info").substr(1));
  EXPECT_EQ(update({}).exit_code, 65);
  EXPECT_EQ(folder.read("new.map"), with_info);
  std::filesystem::remove(path("old.map.info"));
  const auto run = update({});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("no old.map.info of it"), std::string::npos) << run.err;
  EXPECT_NE(folder.read("new.map"), with_info);
}

TEST_F(Update, MayTakeTheOldMapsPlace) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  const auto run = run_mapbuilder({"update", path("old.map"), path("now"), "-o", path("old.map")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_map_file(path("old.map"))->submaps[0].markers.size(), 41U);
}

}  // namespace
}  // namespace waymark
