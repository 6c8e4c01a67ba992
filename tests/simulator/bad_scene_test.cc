#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "simulator/rig_library.h"
#include "simulator/scene_file.h"
#include "simulator/scene_library.h"
#include "tests/support/temporary_folder.h"

namespace waymark::simulator {
namespace {

using testing::HasSubstr;

constexpr std::string_view kGood = R"(name = "small"
title = "Small"
room_size_m = [6.0, 5.0, 3.0]
[markers]
family = "aruco_4x4_1000"
size_m = 0.30
[[ids]]
first = 0
last = 3
[[walls]]
name = "divider"
from_m = [2.0, 0.0]
to_m = [2.0, 1.0]
[[boxes]]
name = "desk"
min_m = [2.5, 2.0, 0.0]
max_m = [3.5, 3.0, 0.8]
[[marker_grids]]
on = "room.north"
rows_m = [1.0, 2.0]
columns = 2
[trajectory]
positions = 10
waypoints = [
  { at_m = [1.5, 2.5, 1.2] }, { at_m = [3.0, 1.2, 1.2] }, { at_m = [4.5, 2.5, 1.2] },
  { at_m = [3.0, 3.8, 1.2] },
]
)";

/// The good scene with one text replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text(kGood);
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

struct Flaw {
  std::string name, from, to, message;
};

/// What GoogleTest shows as the parameter.
void PrintTo(const Flaw& flaw, std::ostream* out) { *out << flaw.name; }

class BadScene : public testing::TestWithParam<Flaw> {};

INSTANTIATE_TEST_SUITE_P(
    Flaws, BadScene,
    testing::Values(
        Flaw{"Syntax", "room_size_m = [", "room_size_m = [[", "not valid TOML"},
        Flaw{"UnknownKey", "positions = 10", "positions = 10\nspeed = 3", "unknown key \"speed\""},
        Flaw{"NoRoom", "room_size_m = [6.0, 5.0, 3.0]", "", "room_size_m"},
        Flaw{"FlatRoom", "[6.0, 5.0, 3.0]", "[6.0, 0.0, 3.0]", "room_size_m must be above 0"},
        Flaw{"NotANumber", "[6.0, 5.0, 3.0]", "[6.0, nan, 3.0]", "3 numbers"},
        Flaw{"BoxOutside", "max_m = [3.5, 3.0, 0.8]", "max_m = [7.5, 3.0, 0.8]", "out of the room"},
        Flaw{"UnknownSurface", "room.north", "room.up", "no surface is called"},
        Flaw{"UnknownFamily", "aruco_4x4_1000", "aruco_9x9", "unknown family"},
        Flaw{"TooFewIds", "last = 3", "last = 2", "4 places for markers, but 3 ids"},
        Flaw{"HangsOver", "rows_m = [1.0, 2.0]", "rows_m = [1.0, 2.95]", "hangs over the edge"},
        Flaw{"Overlap", "rows_m = [1.0, 2.0]", "rows_m = [1.0, 1.2]", "overlap"},
        Flaw{"NegativeSize", "size_m = 0.30", "size_m = -0.30", "size_m"},
        Flaw{"NoPositions", "positions = 10", "positions = 0", "positions"},
        Flaw{"ThroughBox", "{ at_m = [3.0, 1.2, 1.2] }", "{ at_m = [3.0, 2.5, 0.5] }", "through"},
        Flaw{"ThroughWall", "{ at_m = [3.0, 1.2, 1.2] }",
             "{ at_m = [1.0, 0.8, 1.2] }, { at_m = [3.0, 0.8, 1.2] }", "through a wall"},
        Flaw{"OutOfTheRoom", "{ at_m = [4.5, 2.5, 1.2] }", "{ at_m = [6.5, 2.5, 1.2] }", "through"},
        Flaw{"TwoWaypoints", ", { at_m = [4.5, 2.5, 1.2] },\n  { at_m = [3.0, 3.8, 1.2] }", "",
             "3 waypoints or more"}),
    [](const auto& info) { return info.param.name; });

TEST_P(BadScene, EndsInOneLineThatNamesIt) {
  const auto scene = parse_scene(with(GetParam().from, GetParam().to), "flawed.toml");
  ASSERT_FALSE(scene.has_value());
  EXPECT_EQ(scene.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(scene.error().message, HasSubstr(GetParam().message));
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
}

TEST(Scene, WithoutFlawIsRead) {
  const auto scene = parse_scene(kGood, "good.toml");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(scene->markers.size(), 4U);
}

TEST(SceneLibrary, UnknownNamesAreNoInput) {
  const auto scene = load_scene("kitchen");
  ASSERT_FALSE(scene.has_value());
  EXPECT_EQ(scene.error().kind, ErrorKind::no_input);
  EXPECT_THAT(scene.error().message, HasSubstr("room1"));
  EXPECT_EQ(load_scene("aisles3").error().kind, ErrorKind::usage);
  EXPECT_EQ(load_scene("aisles102").error().kind, ErrorKind::usage);
}

TEST(RigLibrary, RigsThatCannotBeMountedAreRefused) {
  EXPECT_EQ(load_rig("cg90").error().kind, ErrorKind::no_input);
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    const auto path = folder.path() / "rig.yaml";
    std::ofstream(path) << text;
    const auto rig = load_rig(path.string());
    return rig.has_value() ? std::string("accepted") : rig.error().message;
  };
  EXPECT_NE(refused("{}\n"), "accepted");
  EXPECT_NE(refused(""), "accepted");
  const std::string camera =
      "  camera_model: pinhole\n  intrinsics: [500, 500, 320, 240]\n"
      "  distortion_model: none\n  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [640, 480]\n";
  EXPECT_EQ(refused("cam0:\n" + camera), "accepted");
  EXPECT_THAT(refused("cam0:\n" + camera + "cam1:\n" + camera), HasSubstr("T_cn_cnm1"));
}

}  // namespace
}  // namespace waymark::simulator
