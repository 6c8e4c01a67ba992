#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "core/map/map_file.h"
#include "tests/mapbuilder/program/run_program.h"

namespace waymark {
namespace {

using test::run_mapbuilder;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

/// A room, captured; commands on it.
class Findings : public testing::Test {
 protected:
  Findings() {
    test::RoomOptions options;
    options.noise_px = 0.2;
    room = test::make_room(options);
    test::write_capture(room, path("room"));
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder.path() / name).string();
  }

  [[nodiscard]] bool exists(const std::string& name) const {
    return std::filesystem::exists(path(name));
  }

  [[nodiscard]] static test::ProgramRun build(const std::string& capture, const std::string& map,
                                              const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"build", capture, "-o", map};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_mapbuilder(arguments);
  }

  /// The room with a marker of its own, seen alone, twice: a part of one marker. (Seen once it
  /// would be as likely a misreading.)
  void write_stray() {
    test::SyntheticRoom stray = room;
    const ImageDetections& last = room.images.back();
    int views = 0;
    for (auto image = room.images.rbegin(); image != room.images.rend() && views < 2; ++image) {
      const auto seen = std::find_if(
          image->detections.begin(), image->detections.end(),
          [&](const Detection& d) { return d.marker == last.detections.front().marker; });
      if (image->camera != last.camera || seen == image->detections.end()) continue;
      ImageDetections far = *image;
      far.stamp += std::chrono::seconds(50);
      far.detections.assign(1, *seen);
      far.detections.front().marker.number = 500;
      stray.images.push_back(far);
      ++views;
    }
    ASSERT_EQ(views, 2);
    test::write_capture(stray, path("stray"));
  }

  test::TemporaryFolder folder;
  test::SyntheticRoom room;
};

TEST_F(Findings, AnErrorKeepsTheMapFromItsPlaceAndEverythingElseToo) {
  // Another building, in whose map this one has no place.
  test::RoomOptions options;
  options.noise_px = 0.2;
  options.seed = 7;
  auto other = test::make_room(options);
  for (ImageDetections& image : other.images) {
    for (Detection& d : image.detections) d.marker.number = (d.marker.number * 7 + 3) % 40;
  }
  test::write_capture(other, path("other"));
  ASSERT_EQ(build(path("other"), path("other.map")).exit_code, 0);
  folder.write("room.map", "what was there before");
  const std::vector<std::string> options_of_both{"--frame-of",   path("other.map"), "--report",
                                                 path("report"), "--trajectory",    path("r.tum"),
                                                 "--refine",     "intrinsics"};
  const auto refused = build(path("room"), path("room.map"), options_of_both);
  EXPECT_EQ(refused.exit_code, 65) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("error [other_place] " + path("other.map") + ": "));
  EXPECT_THAT(refused.err, HasSubstr("room.map.rejected"));
  EXPECT_EQ(folder.read("room.map"), "what was there before");
  EXPECT_EQ(read_map_file(path("room.map.rejected"))->submaps[0].markers.size(), 40U);
  EXPECT_FALSE(exists("r.tum"));
  EXPECT_FALSE(exists("room.yaml"));
  const auto first = nlohmann::json::parse(folder.read("report/summary.json")).at("findings").at(0);
  EXPECT_EQ(first.at("severity"), "error");
  EXPECT_EQ(first.at("cause"), "other_place");
  for (const char* key : {"subject", "value", "sigma", "unit", "explains", "text", "remedy"}) {
    EXPECT_TRUE(first.contains(key)) << key;
  }

  auto accepting = options_of_both;
  accepting.emplace_back("--accept-errors");
  const auto accepted = build(path("room"), path("room.map"), accepting);
  EXPECT_EQ(accepted.exit_code, 0) << accepted.err;
  EXPECT_THAT(accepted.err, HasSubstr("error [other_place]"));
  EXPECT_EQ(read_map_file(path("room.map"))->submaps[0].markers.size(), 40U);
  EXPECT_TRUE(exists("r.tum"));
}

TEST_F(Findings, StrictMakesWarningsErrors) {
  write_stray();
  const auto lenient = build(path("stray"), path("s.map"));
  EXPECT_EQ(lenient.exit_code, 0) << lenient.err;
  EXPECT_THAT(lenient.err, HasSubstr("warning [disconnected] 2 parts: "));
  const auto strict = build(path("stray"), path("t.map"), {"--strict"});
  EXPECT_EQ(strict.exit_code, 65);
  EXPECT_THAT(strict.err, HasSubstr("error [disconnected] 2 parts: "));
  EXPECT_FALSE(exists("t.map"));
  EXPECT_EQ(build(path("stray"), path("t.map"), {"--strict", "--accept-errors"}).exit_code, 0);
  // A note is none.
  EXPECT_EQ(build(path("room"), path("r.map"), {"--strict"}).exit_code, 0);
}

TEST_F(Findings, LevellingLevelsWhatItCanAndNamesTheRest) {
  write_stray();
  for (const char* by : {"walls", "floor"}) {
    const auto run = build(path("stray"), path("s.map"), {"--level", by});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("warning [not_level] sub-map ")) << by;
  }
  ASSERT_EQ(build(path("stray"), path("s.map"), {"--level", "walls"}).exit_code, 0);
  const auto map = read_map_file(path("s.map"));
  ASSERT_TRUE(map);
  ASSERT_EQ(map->submaps.size(), 2U);
  EXPECT_TRUE(map->submaps[0].z_is_up);
  EXPECT_FALSE(map->submaps[1].z_is_up);
}

TEST_F(Findings, APartOfOneMarkerHasNoSigmaOfZero) {
  write_stray();
  ASSERT_EQ(build(path("stray"), path("s.map")).exit_code, 0);
  const auto map = read_map_file(path("s.map"));
  ASSERT_TRUE(map);
  EXPECT_TRUE(map->submaps[0].markers[0].covariance_known());
  EXPECT_FALSE(map->submaps[1].markers[0].covariance_known());
}

TEST_F(Findings, SurveyPointsAndAnEarlierMapDoNotBothNameTheWorld) {
  ASSERT_EQ(build(path("room"), path("old.map")).exit_code, 0);
  const auto point = [](const char* use) {
    return std::string("[[points]]\nid = 1\ncorner = \"center\"\nposition_m = [1, 2, 1]\n") +
           "sigma_m = 0.01\nuse = \"" + use + "\"\n";
  };
  folder.write("fit.toml", point("fit"));
  const auto both = build(path("room"), path("new.map"),
                          {"--survey", path("fit.toml"), "--frame-of", path("old.map")});
  EXPECT_EQ(both.exit_code, 64) << both.err;
  EXPECT_THAT(both.err, HasSubstr("each name a world"));
  folder.write("check.toml", point("check"));
  EXPECT_EQ(build(path("room"), path("new.map"),
                  {"--survey", path("check.toml"), "--frame-of", path("old.map")})
                .exit_code,
            0);
}

TEST_F(Findings, ABareIdInASurveyNeedsAFamilyWhereSeveralAreStatedThoughOneIsSeen) {
  auto entries = room.catalog.entries();
  entries.push_back({Family::tag25h9, 0.1, {}, {}});
  room.catalog = MarkerCatalog(entries);
  test::write_capture(room, path("room"));
  folder.write("s.toml", "[[points]]\nid = 1\nposition_m = [1, 2, 1]\nsigma_m = 0.01\n");
  const auto run = build(path("room"), path("r.map"), {"--survey", path("s.toml")});
  EXPECT_EQ(run.exit_code, 65) << run.err;
  EXPECT_THAT(run.err, HasSubstr("s.toml"));
}

TEST_F(Findings, RefineTakesOneArgument) {
  const auto run =
      run_mapbuilder({"build", "--refine", "sizes,intrinsics", path("room"), "-o", path("r.map")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(
      run_mapbuilder({"build", path("room"), "-o", path("r.map"), "--refine", "walls"}).exit_code,
      64);
}

TEST_F(Findings, NoOptionTakesWhatIsNoNumber) {
  for (const char* option :
       {"--gate-sigmas", "--loss-sigmas", "--lambda-distance", "--lambda-angle",
        "--lambda-ambiguity", "--epsilon-rad", "--max-distance-m", "--max-angle-rad"}) {
    for (const char* value : {"nan", "-nan", "inf", "-1", "1e300"}) {
      EXPECT_EQ(build(path("room"), path("r.map"), {std::string(option) + "=" + value}).exit_code,
                64)
          << option << " " << value;
    }
  }
}

TEST_F(Findings, NoCommandSpeaksOfAnOptionThatItLacks) {
  folder.write("room/survey.toml", "");
  const auto built = build(path("room"), path("r.map"));
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("--survey"));
  const auto localized = run_mapbuilder(
      {"localize", path("room"), "--map", path("r.map"), "--trajectory", path("t.tum")});
  EXPECT_EQ(localized.exit_code, 0) << localized.err;
  EXPECT_THAT(localized.err, Not(HasSubstr("--survey")));
}

TEST_F(Findings, WhatIsReadIsNeverReplaced) {
  ASSERT_EQ(build(path("room"), path("r.map")).exit_code, 0);
  const std::string map = folder.read("r.map");
  const std::string rig = folder.read("room/rig.yaml");
  EXPECT_EQ(run_mapbuilder(
                {"localize", path("room"), "--map", path("r.map"), "--trajectory", path("r.map")})
                .exit_code,
            64);
  EXPECT_EQ(build(path("room"), path("room/rig.yaml")).exit_code, 64);
  EXPECT_EQ(
      build(path("room"), path("r2.map"), {"--trajectory", path("room/markers.toml")}).exit_code,
      64);
  ASSERT_EQ(
      run_mapbuilder({"export", path("r.map"), "--format", "json", "-o", path("r.json")}).exit_code,
      0);
  EXPECT_EQ(run_mapbuilder({"import", path("r.json"), "-o", path("r.json")}).exit_code, 64);
  EXPECT_EQ(
      run_mapbuilder({"export", path("r.map"), "--format", "csv", "-o", path("r.map")}).exit_code,
      64);
  EXPECT_EQ(folder.read("r.map"), map);
  EXPECT_EQ(folder.read("room/rig.yaml"), rig);
}

TEST_F(Findings, APathThatCannotBeFollowedIsNoInternalError) {
  ASSERT_EQ(build(path("room"), path("r.map")).exit_code, 0);
  std::filesystem::create_directories(path("room/groundtruth"));
  folder.write("room/groundtruth/rig.tum", "1.0 0 0 0 0 0 0 1\n");
  std::filesystem::create_symlink("loop", path("loop"));
  const auto run = run_mapbuilder({"evaluate", "--map", path("r.map"), "--trajectory",
                                   path("loop/t.tum"), "--truth", path("room/groundtruth")});
  EXPECT_THAT(run.exit_code, AnyOf(66, 74)) << run.err;
  EXPECT_THAT(run.err, HasSubstr("loop/t.tum: "));
  EXPECT_EQ(build(path("room"), path("loop/r.map")).exit_code, 73);
}

}  // namespace
}  // namespace waymark
