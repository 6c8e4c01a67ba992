#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/map/map_file.h"
#include "core/map/marker_search.h"
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

}  // namespace
}  // namespace waymark
