#include "mapbuilder/build/trajectory_file.h"

#include <filesystem>

#include "core/geometry/tum.h"
#include "tests/mapbuilder/observations/room_observations.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

TEST(TrajectoryFile, KeepsStampsExactlyAndNamesFilesBySubMapAndCamera) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "out.tum";
  const auto room = test::make_room({});
  const auto observations = test::observations_of(room);
  const Rigid3 pose{so3_exp({0.1, 0.2, 0.3}), {1, 2, 3}};
  ASSERT_TRUE(write_trajectory(path, 0, observations,
                               {{FrameSetIndex(4), pose}, {FrameSetIndex(2), Rigid3{}}}));
  ASSERT_TRUE(write_trajectory(path, 1, observations, {{FrameSetIndex(0), pose}}));
  const auto first = read_tum(path);
  ASSERT_TRUE(first);
  ASSERT_EQ(first->size(), 2U);
  EXPECT_EQ((*first)[0].key, "1.200000000");
  EXPECT_EQ((*first)[1].key, "1.400000000");
  EXPECT_LT((*first)[1].pose.minus(pose).norm(), 1e-8);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out.1.tum"));

  const auto mono = test::observations_of(room, {true, 1});
  ASSERT_TRUE(
      write_trajectory(path, 0, mono, {{FrameSetIndex(0), pose}, {FrameSetIndex(1), pose}}));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out.cam0.tum"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out.cam1.tum"));
}

}  // namespace
}  // namespace waymark
