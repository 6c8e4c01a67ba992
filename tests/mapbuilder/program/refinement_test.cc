#include <gtest/gtest.h>

#include "tests/mapbuilder/program/run_program.h"

namespace waymark {
namespace {

using test::run_mapbuilder;

/// A capture that can't support a refinement, and what must be said.
struct Unsupported {
  const char* name;
  test::RoomOptions room;
  const char* refine;
  const char* reason;  ///< part of the line
};

std::ostream& operator<<(std::ostream& out, const Unsupported& one) { return out << one.name; }

/// The rig turns on the spot: 29°, which tells three cameras little of each other, and 6°, which
/// tells a camera little of itself. (By 29° three cameras learn most of their lenses.)
constexpr double kTurn_rad = 0.5;
constexpr double kLook_rad = 0.1;

test::RoomOptions room(int cameras, int frame_sets, double turn_rad = -1) {
  test::RoomOptions options;
  options.noise_px = 0.2;
  options.cameras = cameras;
  options.frame_sets = frame_sets;
  options.turn_in_place_rad = turn_rad;
  return options;
}

class UnsupportedRefinement : public testing::TestWithParam<Unsupported> {};

TEST_P(UnsupportedRefinement, IsRefusedWithTheReasonAndTheMapIsThatWithoutIt) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room(GetParam().room), folder.path() / "room");
  const std::string capture = (folder.path() / "room").string();
  const auto path = [&](const char* name) { return (folder.path() / name).string(); };
  const auto plain =
      run_mapbuilder({"build", capture, "-o", path("plain.map"), "--trajectory", path("p.tum")});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  const auto refined = run_mapbuilder({"build", capture, "-o", path("refined.map"), "--trajectory",
                                       path("r.tum"), "--refine", GetParam().refine});
  EXPECT_EQ(refined.exit_code, 0) << refined.err;
  EXPECT_NE(refined.err.find("The refinement was refused"), std::string::npos) << refined.err;
  EXPECT_NE(refined.err.find(GetParam().reason), std::string::npos) << refined.err;
  EXPECT_EQ(folder.read("refined.map"), folder.read("plain.map"));
  EXPECT_EQ(folder.read("r.tum"), folder.read("p.tum"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "refined.yaml"));
}

TEST(RefinedRig, NeverTakesThePlaceOfAnotherFileOfTheBuild) {
  const test::TemporaryFolder folder;
  test::write_capture(test::make_room(room(3, 20)), folder.path() / "room");
  const std::string capture = (folder.path() / "room").string();
  const std::string stated = folder.read("room/rig.yaml");
  const auto refine = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "build", capture, "-o", (folder.path() / output).string(), "--refine", "extrinsics"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_mapbuilder(arguments);
  };
  const auto beside = refine("room/rig.map", {});
  EXPECT_EQ(beside.exit_code, 64) << beside.err;
  EXPECT_NE(beside.err.find("--refined-rig"), std::string::npos) << beside.err;
  EXPECT_EQ(folder.read("room/rig.yaml"), stated);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "room/rig.map"));
  EXPECT_EQ(refine("site.yaml", {}).exit_code, 64);
  const auto nowhere =
      refine("site.map", {"--refined-rig", (folder.path() / "absent" / "r.yaml").string()});
  EXPECT_NE(nowhere.exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "site.map"));
}

INSTANTIATE_TEST_SUITE_P(
    Refinement, UnsupportedRefinement,
    testing::Values(
        Unsupported{"OneCameraExtrinsics", room(1, 60), "extrinsics", "a rig of one camera"},
        Unsupported{"OneCameraSizes", room(1, 60), "sizes", "measure a distance"},
        Unsupported{"OneViewExtrinsics", room(3, 1), "extrinsics", "can't be told"},
        Unsupported{"OneViewIntrinsics", room(3, 1), "intrinsics", "can't be told"},
        Unsupported{"OneViewSizes", room(3, 1), "sizes", "measure a distance"},
        Unsupported{"OneViewOneCameraIntrinsics", room(1, 1), "intrinsics", "can't be told"},
        Unsupported{"TurnExtrinsics", room(3, 60, kTurn_rad), "extrinsics", "can't be told"},
        Unsupported{"TurnIntrinsics", room(1, 10, kLook_rad), "intrinsics", "can't be told"},
        Unsupported{"TurnSizes", room(3, 60, kTurn_rad), "sizes", "measure a distance"},
        Unsupported{"TurnAll", room(3, 60, kTurn_rad), "extrinsics,intrinsics,sizes",
                    "can't be told"}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace waymark
