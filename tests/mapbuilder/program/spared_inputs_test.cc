#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>

#include "tests/mapbuilder/program/run_program.h"

namespace waymark {
namespace {

using test::run_mapbuilder;

/// A room's capture with all that may lie in one, a map of it, and names that lead to both.
class SparedInputs : public testing::Test {
 protected:
  SparedInputs() {
    test::RoomOptions options;
    options.noise_px = 0.2;
    test::write_capture(test::make_room(options), folder.path() / "room");
    EXPECT_EQ(run_mapbuilder({"build", path("room"), "-o", path("a.map")}).exit_code, 0);
    for (const char* file :
         {"cam0/1700000000000000000.jpg", "images/left.png", "groundtruth/rig.tum", "frames.csv",
          "survey.toml", "capture.toml", "sfm.toml", "calib.json", "marker_gt.txt", "cam_gt.txt"}) {
      folder.write(std::filesystem::path("room") / file, "as it was");
    }
    folder.write("elsewhere.jpg", "as it was");
    std::filesystem::create_symlink(path("elsewhere.jpg"),
                                    path("room/cam0/1700000000000000001.jpg"));
    std::filesystem::create_symlink("a.map", path("link.tum"));
    std::filesystem::create_directory_symlink("room/cam0", path("way"));
    folder.write("quarantine.json", "as it was");
    folder.write("video.mp4", "as it was");
    folder.write("rig.yaml", "as it was");
    folder.write("markers.toml", "as it was");
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder.path() / name).string();
  }

  [[nodiscard]] std::map<std::string, std::string> content() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      all[entry.path().string()] = {std::istreambuf_iterator<char>(file), {}};
    }
    return all;
  }

  /// The command is refused for its use, and every file is as it was. Arguments but
  /// for the command and options are paths.
  void expect_refused(std::vector<std::string> arguments) const {
    std::string told;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      told += arguments[i] + " ";
      if (i > 0 && arguments[i].front() != '-') arguments[i] = path(arguments[i]);
    }
    const auto before = content();
    const auto run = run_mapbuilder(arguments);
    EXPECT_EQ(run.exit_code, 64) << told << run.err;
    EXPECT_TRUE(content() == before) << told;
  }

  test::TemporaryFolder folder;
};

const std::vector<std::string> kOfACapture{"room/rig.yaml",
                                           "room/markers.toml",
                                           "room/capture.toml",
                                           "room/frames.csv",
                                           "room/survey.toml",
                                           "room/sfm.toml",
                                           "room/calib.json",
                                           "room/marker_gt.txt",
                                           "room/cam_gt.txt",
                                           "room/images/left.png",
                                           "room/groundtruth/rig.tum",
                                           "room/cam0/1700000000000000000.jpg",
                                           "room/cam0/new.jpg",
                                           "way/new.jpg",
                                           "elsewhere.jpg"};

TEST_F(SparedInputs, NoCommandReplacesAFileOfItsCapture) {
  for (const std::string& file : kOfACapture) {
    expect_refused({"detect", "room", "-o", file});
    expect_refused({"build", "room", "-o", file});
    expect_refused({"build", "room", "-o", "b.map", "--trajectory", file});
    expect_refused({"localize", "room", "--map", "a.map", "--trajectory", file});
    expect_refused({"update", "a.map", "room", "-o", file});
  }
}

TEST_F(SparedInputs, DetectionsAreReplacedByDetectAlone) {
  expect_refused({"build", "room", "-o", "room/detections.csv"});
  expect_refused({"build", "room", "-o", "b.map", "--trajectory", "room/detections.csv"});
  expect_refused({"localize", "room", "--map", "a.map", "--trajectory", "room/detections.csv"});
  expect_refused({"update", "a.map", "room", "-o", "room/detections.csv"});
  std::filesystem::remove(path("room/detections.csv"));
  std::filesystem::create_symlink("rig.yaml", path("room/detections.csv"));
  expect_refused({"detect", "room"});
}

TEST_F(SparedInputs, NoCommandReplacesAnotherFileThatItReads) {
  for (const char* file : {"a.map", "./a.map", "link.tum"}) {
    expect_refused({"localize", "room", "--map", "a.map", "--trajectory", file});
    expect_refused({"build", "room", "-o", "b.map", "--frame-of", "a.map", "--trajectory", file});
    expect_refused({"build", "room", "-o", "b.map", "--frame-of", "a.map", "--refine=extrinsics",
                    "--refined-rig", file});
  }
  expect_refused({"localize", "room", "--map", "a.map", "--quarantine", "quarantine.json",
                  "--trajectory", "quarantine.json"});
  for (const char* file : {"video.mp4", "rig.yaml", "markers.toml"}) {
    expect_refused({"localize", "video.mp4", "--rig", "rig.yaml", "--markers", "markers.toml",
                    "--map", "a.map", "--trajectory", file});
    expect_refused({"update", "a.map", "video.mp4", "--rig", "rig.yaml", "--markers",
                    "markers.toml", "-o", file});
  }
}

TEST_F(SparedInputs, WhatIsWrittenBesideAMapReplacesNothingThatIsRead) {
  for (const char* name : {"b.map.info", "b.map.rejected", "b.map.rejected.info"}) {
    std::filesystem::copy_file(path("a.map"), path(name));
    expect_refused({"build", "room", "-o", "b.map", "--frame-of", name});
    expect_refused({"update", name, "room", "-o", "b.map"});
    expect_refused({"build", "room", "-o", "b.map", "--trajectory", name});
    std::filesystem::remove(path(name));
  }
}

TEST_F(SparedInputs, AnEarlierMapAloneMayBeReplaced) {
  for (const char* file :
       {"cam0", "images", "groundtruth", "frames.csv", "survey.toml", "capture.toml"}) {
    std::filesystem::remove_all(folder.path() / "room" / file);
  }
  const auto built =
      run_mapbuilder({"build", path("room"), "-o", path("a.map"), "--frame-of", path("a.map")});
  EXPECT_EQ(built.exit_code, 0) << built.err;
  const auto localized = run_mapbuilder(
      {"localize", path("room"), "--map", path("a.map"), "--trajectory", path("room/own.tum")});
  EXPECT_EQ(localized.exit_code, 0) << localized.err;
}

}  // namespace
}  // namespace waymark
