#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/geometry/tum.h"
#include "core/map/map_file.h"
#include "tests/mapbuilder/program/run_program.h"

namespace waymark {
namespace {

using test::run_mapbuilder;

/// A capture of a room, built once into a map.
class MainPath : public testing::Test {
 protected:
  MainPath() {
    test::RoomOptions options;
    options.noise_px = 0.2;
    room = test::make_room(options);
    test::write_capture(room, folder.path() / "room");
    capture = (folder.path() / "room").string();
    map = (folder.path() / "room.map").string();
    trajectory = (folder.path() / "room.tum").string();
    built = run_mapbuilder({"build", capture, "-o", map, "--trajectory", trajectory});
  }

  void write_truth() {
    std::filesystem::create_directories(folder.path() / "room/groundtruth");
    std::vector<TumPose> rig;
    std::vector<TumPose> markers;
    for (std::size_t i = 0; i < room.world_from_rig.size(); ++i) {
      rig.push_back(
          {format_stamp_s(test::room_stamp(static_cast<int>(i))), room.world_from_rig[i]});
    }
    for (std::size_t i = 0; i < room.world_from_marker.size(); ++i) {
      markers.push_back({std::to_string(i), room.world_from_marker[i]});
    }
    folder.write("room/groundtruth/rig.tum", format_tum(rig));
    folder.write("room/groundtruth/markers.tum", format_tum(markers));
  }

  test::TemporaryFolder folder;
  test::SyntheticRoom room;
  std::string capture;
  std::string map;
  std::string trajectory;
  test::ProgramRun built;
};

TEST_F(MainPath, BuildsAMapAndATrajectory) {
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_NE(built.out.find("40 markers, 60 frame sets localized"), std::string::npos) << built.out;
  const auto read = read_map_file(map);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->submaps.front().markers.size(), 40U);
  const auto poses = read_tum(trajectory);
  ASSERT_TRUE(poses);
  EXPECT_EQ(poses->size(), 60U);
}

TEST_F(MainPath, EvaluatesAgainstTheTruth) {
  write_truth();
  const auto run = run_mapbuilder({"evaluate", "--map", map, "--trajectory", trajectory, "--truth",
                                   capture + "/groundtruth", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  const auto& submap = json.at("submaps").at(0);
  EXPECT_EQ(submap.at("markers").at("found"), 40);
  EXPECT_LT(submap.at("markers").at("translation_rmse_m").get<double>(), 0.01);
  EXPECT_LT(submap.at("cameras").at("translation_rmse_m").get<double>(), 0.01);
}

TEST_F(MainPath, LocalizesAnotherCaptureAgainstTheMap) {
  test::RoomOptions other;
  other.noise_px = 0.2;
  other.frame_sets = 25;
  other.seed = 1;
  test::write_capture(test::make_room(other), folder.path() / "other");
  const auto poses = (folder.path() / "other.tum").string();
  const auto run = run_mapbuilder(
      {"localize", (folder.path() / "other").string(), "--map", map, "--trajectory", poses});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_tum(poses)->size(), 25U);
}

TEST_F(MainPath, ReportsWithTheTruthBesideTheTrajectory) {
  write_truth();
  const auto report = (folder.path() / "report").string();
  const auto run = run_mapbuilder({"build", capture, "-o", map, "--report", report});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = nlohmann::json::parse(folder.read("report/summary.json"));
  EXPECT_EQ(summary.at("map"), "room.map");
  EXPECT_EQ(summary.at("content_hash"), content_hash(*read_map_file(map)));
  const auto& submap = summary.at("submaps").at(0);
  EXPECT_EQ(submap.at("markers").size(), 40U);
  EXPECT_EQ(submap.at("tracks").at(0).at("poses"), 60);
  EXPECT_EQ(submap.at("tracks").at(0).at("true_poses"), 60);
  EXPECT_LT(submap.at("tracks").at(0).at("translation_rmse_m").get<double>(), 0.01);
  EXPECT_NE(folder.read("report/index.html").find("room.map"), std::string::npos);
}

TEST_F(MainPath, AFolderThatIsNoReportIsLeftAloneAndNothingIsWritten) {
  folder.write("photos/holiday.jpg", "x");
  const auto fresh = (folder.path() / "fresh.map").string();
  const auto run = run_mapbuilder(
      {"build", capture, "-o", fresh, "--report", (folder.path() / "photos").string()});
  EXPECT_EQ(run.exit_code, 73);
  EXPECT_EQ(test::error_lines(run), 1) << run.err;
  EXPECT_FALSE(std::filesystem::exists(fresh));
  EXPECT_EQ(folder.read("photos/holiday.jpg"), "x");
}

TEST_F(MainPath, ADiskThatIsFullLeavesTheEarlierReport) {
  const auto report = (folder.path() / "report").string();
  ASSERT_EQ(run_mapbuilder({"build", capture, "-o", map, "--report", report}).exit_code, 0);
  const std::string before = folder.read("report/index.html");
  const std::string map_before = folder.read("room.map");
  // Enough for the summary, too little for the page.
  const auto run = run_mapbuilder({"build", capture, "-o", map, "--report", report}, 100'000);
  EXPECT_EQ(run.exit_code, 74);
  EXPECT_EQ(folder.read("report/index.html"), before);
  EXPECT_EQ(folder.read("room.map"), map_before);
}

TEST_F(MainPath, ExportImportAndInfoKeepTheMap) {
  const auto json = (folder.path() / "room.json").string();
  const auto again = (folder.path() / "again.map").string();
  ASSERT_EQ(run_mapbuilder({"export", map, "--format", "json", "-o", json}).exit_code, 0);
  ASSERT_EQ(run_mapbuilder({"import", json, "-o", again}).exit_code, 0);
  EXPECT_EQ(content_hash(*read_map_file(map)), content_hash(*read_map_file(again)));
  const auto info = run_mapbuilder({"info", map, "--json"});
  ASSERT_EQ(info.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(info.out).at("schema"), 1);
}

TEST_F(MainPath, TheSameCommandTwiceGivesTheSameBytes) {
  const std::string first = folder.read("room.map");
  ASSERT_EQ(run_mapbuilder({"build", capture, "-o", map, "--threads", "1"}).exit_code, 0);
  EXPECT_EQ(folder.read("room.map"), first);
}

TEST_F(MainPath, SeveralPartsAreWrittenWithAWarningAndRefusedWhenStrict) {
  auto parts = room;
  for (ImageDetections& image : parts.images) {
    if (image.stamp < test::room_stamp(30)) continue;
    for (Detection& d : image.detections) d.marker.number += 100;
  }
  test::write_capture(parts, folder.path() / "parts");
  const auto source = (folder.path() / "parts").string();
  const auto target = (folder.path() / "parts.map").string();
  const auto strict = run_mapbuilder({"build", source, "-o", target, "--strict"});
  EXPECT_EQ(strict.exit_code, 65);
  EXPECT_FALSE(std::filesystem::exists(target));
  const auto run = run_mapbuilder({"build", source, "-o", target});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.err.find("warning"), std::string::npos);
  EXPECT_EQ(read_map_file(target)->submaps.size(), 2U);
}

}  // namespace
}  // namespace waymark
