#include "mapbuilder/upkeep/map_info.h"

#include <gtest/gtest.h>

#include "core/map/map_edit.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

std::vector<MarkerSystem> some_systems() {
  const MarkerMap map = test::small_map();
  std::vector<MarkerSystem> systems{independent_system(map.submaps[0]), {}};
  systems[0].world_is_fixed = false;
  systems[0].blocks[{2, 0}] = Matrix6d::Constant(0.25);
  return systems;
}

class MapInfo : public testing::Test {
 protected:
  MapInfo() { EXPECT_TRUE(write_map_info(path(), test::small_map(), some_systems())); }
  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "a.map"; }
  test::TemporaryFolder folder_;
};

TEST_F(MapInfo, IsReadAsItWasWritten) {
  const auto read = read_map_info(path(), test::small_map());
  ASSERT_TRUE(read && *read);
  ASSERT_EQ((*read)->size(), 2U);
  const MarkerSystem& first = (**read)[0];
  EXPECT_EQ(first.blocks, some_systems()[0].blocks);
  EXPECT_EQ(first.world_from_marker[1].translation,
            test::small_map().submaps[0].markers[1].world_from_marker.translation);
  EXPECT_FALSE(first.world_is_fixed);
  EXPECT_EQ((**read)[1].markers(), 0);
}

TEST_F(MapInfo, AbsentOrOfAnotherMapIsNone) {
  const auto absent = read_map_info(folder_.path() / "b.map", test::small_map());
  ASSERT_TRUE(absent);
  EXPECT_FALSE(*absent);
  const auto edited = edit_map(test::small_map(), "a.map", {{{Family::tag36h11, 3}}, {}, {}});
  const auto other = read_map_info(path(), *edited);
  ASSERT_TRUE(other);
  EXPECT_FALSE(*other);
}

TEST_F(MapInfo, BlocksOfNoInformationMatrixAreDamage) {
  const auto is_read = [&](const std::pair<int, int>& at, const Matrix6d& block) {
    auto systems = some_systems();
    systems[0].blocks[at] = block;
    EXPECT_TRUE(write_map_info(path(), test::small_map(), systems));
    return read_map_info(path(), test::small_map()).has_value();
  };
  const Matrix6d sound = some_systems()[0].blocks.at({1, 1});
  EXPECT_TRUE(is_read({1, 1}, sound));
  EXPECT_TRUE(is_read({1, 1}, Matrix6d::Zero())) << "nothing is known of it";
  EXPECT_FALSE(is_read({1, 1}, -sound));
  EXPECT_FALSE(is_read({1, 1}, 1e300 * Matrix6d::Ones()));
  EXPECT_FALSE(is_read({2, 0}, 1e200 * Matrix6d::Ones()));
  EXPECT_FALSE(is_read({2, 0}, 10 * sound.maxCoeff() * Matrix6d::Ones()));
  Matrix6d lopsided = sound;
  lopsided(0, 1) += 0.5 * sound.maxCoeff();
  EXPECT_FALSE(is_read({1, 1}, lopsided));
}

TEST_F(MapInfo, EveryFlippedBitAndEveryCutIsFound) {
  const std::string whole = folder_.read("a.map.info");
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 4);
    folder_.write("a.map.info", flipped);
    const auto read = read_map_info(path(), test::small_map());
    ASSERT_FALSE(read) << at;
    EXPECT_EQ(read.error().kind, ErrorKind::bad_data);
  }
  for (std::size_t length = 0; length < whole.size(); length += 11) {
    folder_.write("a.map.info", whole.substr(0, length));
    EXPECT_FALSE(read_map_info(path(), test::small_map())) << length;
  }
}

}  // namespace
}  // namespace waymark
