#include <gtest/gtest.h>

#include <functional>

#include "tests/mapbuilder/program/run_program.h"

namespace waymark {
namespace {

using test::run_mapbuilder;

/// One way to spoil a sound capture, and how the build of it must end.
struct Spoiled {
  const char* name;
  int exit_code;
  const char* message;  ///< part of the one line
  std::function<void(const test::TemporaryFolder&)> spoil;
};

std::ostream& operator<<(std::ostream& out, const Spoiled& spoiled) { return out << spoiled.name; }

void replace(const test::TemporaryFolder& folder, const std::string& file, const std::string& from,
             const std::string& to) {
  std::string text = folder.read(file);
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  folder.write(file, text.replace(at, from.size(), to));
}

/// First line of detections, after comment and header.
void replace_first_row(const test::TemporaryFolder& folder, const std::string& row) {
  const std::string text = folder.read("room/detections.csv");
  const auto first = text.find('\n', text.find('\n') + 1) + 1;
  const auto second = text.find('\n', first) + 1;
  folder.write("room/detections.csv", text.substr(0, first) + row + "\n" + text.substr(second));
}

const std::vector<Spoiled>& spoiled_captures() {
  static const std::vector<Spoiled> all{
      {"NoSuchFolder", 66, "room",
       [](const auto& f) { std::filesystem::remove_all(f.path() / "room"); }},
      {"NoRig", 66, "rig.yaml",
       [](const auto& f) { std::filesystem::remove(f.path() / "room/rig.yaml"); }},
      {"NoMarkers", 66, "markers.toml",
       [](const auto& f) { std::filesystem::remove(f.path() / "room/markers.toml"); }},
      {"NothingToSee", 66, "detections.csv",
       [](const auto& f) { std::filesystem::remove(f.path() / "room/detections.csv"); }},
      {"CameraFolderWithoutEntry", 65, "rig.yaml",
       [](const auto& f) { f.write("room/cam7/1.pgm", "P5 1 1 255 x"); }},
      {"RigIsNoYaml", 65, "rig.yaml", [](const auto& f) { f.write("room/rig.yaml", "cam0: [}"); }},
      {"TransformIsNoRotation", 65, "cam1",
       [](const auto& f) {
         const std::string text = f.read("room/rig.yaml");
         const auto at = text.find("- [", text.find("T_cn_cnm1"));
         ASSERT_NE(at, std::string::npos);
         f.write("room/rig.yaml", std::string(text).replace(at, 3, "- [9"));
       }},
      {"UnknownFamily", 65, "tag99h1",
       [](const auto& f) { replace(f, "room/markers.toml", "tag36h11", "tag99h1"); }},
      {"NegativeSize", 65, "size_m",
       [](const auto& f) { replace(f, "room/markers.toml", "0.3", "-0.3"); }},
      {"StampIsNoNumber", 65, "detections.csv",
       [](const auto& f) { replace_first_row(f, "soon,cam0,1,1,1,2,1,2,2,1,2,0"); }},
      {"CornerIsNaN", 65, "detections.csv",
       [](const auto& f) { replace_first_row(f, "1,cam0,1,nan,1,2,1,2,2,1,2,0"); }},
      {"StaleDetections", 65, "detections.csv",
       [](const auto& f) { replace(f, "room/markers.toml", "0.3", "0.4"); }},
      {"NoMarkerSeen", 65, "no marker",
       [](const auto& f) {
         const std::string text = f.read("room/detections.csv");
         f.write("room/detections.csv",
                 text.substr(0, text.find('\n', text.find('\n') + 1) + 1) + "1,cam0,,,,,,,,,,\n");
       }},
  };
  return all;
}

class BadInput : public testing::TestWithParam<Spoiled> {};

TEST_P(BadInput, EndsInOneClearLineAndOverwritesNothing) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room({}), folder.path() / "room");
  GetParam().spoil(folder);
  folder.write("good.map", "what was there before");
  const auto run = run_mapbuilder(
      {"build", (folder.path() / "room").string(), "-o", (folder.path() / "good.map").string()});
  EXPECT_EQ(run.exit_code, GetParam().exit_code) << run.err;
  EXPECT_EQ(test::error_lines(run), 1) << run.err;
  EXPECT_NE(run.err.find(GetParam().message), std::string::npos) << run.err;
  EXPECT_EQ(folder.read("good.map"), "what was there before");
}

INSTANTIATE_TEST_SUITE_P(Build, BadInput, testing::ValuesIn(spoiled_captures()),
                         [](const auto& info) { return info.param.name; });

TEST(BadUse, OfTheCommandLineIs64) {
  EXPECT_EQ(run_mapbuilder({}).exit_code, 64);
  EXPECT_EQ(run_mapbuilder({"fly"}).exit_code, 64);
  EXPECT_EQ(run_mapbuilder({"build", "room"}).exit_code, 64);
  EXPECT_EQ(run_mapbuilder({"build", "room", "-o", "m", "--loss", "soft"}).exit_code, 64);
  EXPECT_EQ(run_mapbuilder({"build", "room", "-o", "m", "--threads", "many"}).exit_code, 64);
  EXPECT_EQ(run_mapbuilder({"--help"}).exit_code, 0);
  EXPECT_EQ(run_mapbuilder({"--version"}).exit_code, 0);
}

TEST(BadUse, OptionsLieInTheirRanges) {
  for (const char* option :
       {"--gate-sigmas", "--loss-sigmas", "--lambda-distance", "--lambda-angle",
        "--lambda-ambiguity", "--epsilon-rad", "--max-distance-m", "--max-angle-rad"}) {
    for (const char* value : {"nan", "-nan", "inf", "-1", "1e999"}) {
      const auto run =
          run_mapbuilder({"build", "room", "-o", "m", fmt::format("{}={}", option, value)});
      EXPECT_EQ(run.exit_code, 64) << option << " " << value;
      EXPECT_NE(run.err.find("is no number from"), std::string::npos) << run.err;
    }
  }
}

TEST(BadOutput, LinksThatLeadInCirclesAreSaid) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room({}), folder.path() / "room");
  std::filesystem::create_symlink("loop", folder.path() / "loop");
  const std::string room = (folder.path() / "room").string();
  const std::string loop = (folder.path() / "loop").string();
  const std::string map = (folder.path() / "good.map").string();
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"build", room, "-o", loop},
                                             {"build", room, "-o", loop, "--trajectory", loop},
                                             {"build", room, "-o", map, "--trajectory", loop}}) {
    const auto run = run_mapbuilder(arguments);
    EXPECT_TRUE(run.exit_code == 73 || run.exit_code == 64) << run.exit_code << run.err;
    EXPECT_EQ(test::error_lines(run), 1) << run.err;
  }
}

TEST(BadArguments, ReachNoTerminalAsTheyAre) {
  const std::string rude = "x\x1b]0;title\a\r\n\u202e" + std::string(2000, 'y');
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{rude},
                                             {"--" + rude},
                                             {"build", "room", "-o", "x.map", "--" + rude},
                                             {"build", "room", "-o", "x.map", "--loss", rude},
                                             {"build", "room", "-o", "x.map", "--threads", rude}}) {
    const auto run = run_mapbuilder(arguments);
    EXPECT_EQ(run.exit_code, 64) << run.err;
    EXPECT_LT(run.err.size(), 600U);
    EXPECT_EQ(run.err.find_first_of("\x1b\a\r"), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find("\u202e"), std::string::npos) << run.err;
  }
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room({}), folder.path() / "room\x1b[2J");
  const auto built = run_mapbuilder({"build", (folder.path() / "room\x1b[2J").string(), "-o",
                                     (folder.path() / "a\x1b[2J.map").string()});
  EXPECT_EQ(built.exit_code, 0) << built.err;
  EXPECT_EQ((built.out + built.err).find('\x1b'), std::string::npos) << built.out << built.err;
}

TEST(BadOutput, IsSaidBeforeTheWork) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room({}), folder.path() / "room");
  const std::string room = (folder.path() / "room").string();
  const auto absent = run_mapbuilder({"build", room, "-o", room + "/nowhere/x.map"});
  EXPECT_EQ(absent.exit_code, 73);
  EXPECT_EQ(test::error_lines(absent), 1);
  EXPECT_EQ(run_mapbuilder({"build", room, "-o", room}).exit_code, 73);
}

/// What lies in a folder and below.
std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    files += entry.is_regular_file() ? 1 : 0;
  }
  return files;
}

TEST(BadOutput, ANameThatIsTooLongIsSaidBeforeTheWork) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room({}), folder.path() / "room");
  const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
  ASSERT_EQ(run_mapbuilder({"build", path("room"), "-o", path("a.map")}).exit_code, 0);
  ASSERT_EQ(
      run_mapbuilder({"export", path("a.map"), "--format", "json", "-o", path("a.json")}).exit_code,
      0);
  const std::size_t before = files_in(folder.path());
  for (const std::size_t length : {250, 300}) {
    const std::string name = path(std::string(length, 'x'));
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {"build", path("room"), "-o", name},
             {"build", path("room"), "-o", path("b.map"), "--trajectory", name},
             {"build", path("room"), "-o", path("b.map"), "--report", name},
             {"build", path("room"), "-o", path("b.map"), "--refine=intrinsics", "--refined-rig",
              name},
             {"update", path("a.map"), path("room"), "-o", name},
             {"localize", path("room"), "--map", path("a.map"), "--trajectory", name},
             {"detect", path("room"), "-o", name},
             {"edit", path("a.map"), "-o", name, "--remove", "0"},
             {"export", path("a.map"), "--format", "tum", "-o", name},
             {"import", path("a.json"), "-o", name},
             {"print", "--family", "tag36h11", "--ids", "0", "--size-m", "0.1", "-o", name}}) {
      const auto run = run_mapbuilder(arguments);
      EXPECT_EQ(run.exit_code, 73) << arguments[0] << run.err;
      EXPECT_NE(run.err.find("too long"), std::string::npos) << arguments[0] << run.err;
      EXPECT_EQ(files_in(folder.path()), before) << arguments[0];
    }
  }
}

TEST(BadOutput, AFullDiskLeavesTheOldMap) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room({}), folder.path() / "room");
  folder.write("good.map", "what was there before");
  const auto run = run_mapbuilder(
      {"build", (folder.path() / "room").string(), "-o", (folder.path() / "good.map").string()},
      2000);
  EXPECT_EQ(run.exit_code, 74) << run.err;
  EXPECT_EQ(test::error_lines(run), 1) << run.err;
  EXPECT_EQ(folder.read("good.map"), "what was there before");
  // Nothing half-written lies about either.
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    files += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_EQ(files, 1);
}

TEST(BadMap, OfEveryKindIsRefused) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room({}), folder.path() / "room");
  const std::string room = (folder.path() / "room").string();
  const std::string map = (folder.path() / "room.map").string();
  ASSERT_EQ(run_mapbuilder({"build", room, "-o", map}).exit_code, 0);
  const std::string good = folder.read("room.map");

  std::string flipped = good;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 4);
  std::string newer = good;
  newer[8] = 99;
  for (const std::string& bad :
       {flipped, newer, good.substr(0, good.size() - 1), std::string("GIF")}) {
    folder.write("bad.map", bad);
    const auto info = run_mapbuilder({"info", (folder.path() / "bad.map").string()});
    EXPECT_EQ(info.exit_code, 65) << info.err;
    EXPECT_EQ(test::error_lines(info), 1) << info.err;
    const auto localize =
        run_mapbuilder({"localize", room, "--map", (folder.path() / "bad.map").string(),
                        "--trajectory", (folder.path() / "x.tum").string()});
    EXPECT_EQ(localize.exit_code, 65) << localize.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "x.tum"));
  }
  EXPECT_EQ(run_mapbuilder({"info", (folder.path() / "absent.map").string()}).exit_code, 66);
}

}  // namespace
}  // namespace waymark
