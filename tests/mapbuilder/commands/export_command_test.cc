#include "mapbuilder/commands/export_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/map/map_export.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;

class ExportCommand : public ::testing::Test {
 protected:
  ExportCommand() { EXPECT_TRUE(write_map_file(folder_.path() / "a.map", map_)); }

  [[nodiscard]] Status run(const std::string& format, const std::string& output) {
    return run_export({folder_.path() / "a.map", format, folder_.path() / output}, notes_);
  }

  test::TemporaryFolder folder_;
  const MarkerMap map_ = test::small_map();
  std::ostringstream notes_;
};

TEST_F(ExportCommand, SubMapsGoToFilesOfTheirOwn) {
  ASSERT_TRUE(run("tum", "out.tum"));
  EXPECT_EQ(folder_.read("out.tum"), format_submap_tum(map_.submaps[0], false));
  EXPECT_EQ(folder_.read("out.1.tum"), format_submap_tum(map_.submaps[1], false));
  EXPECT_THAT(notes_.str(), HasSubstr("sub-map 1 is in "));
  ASSERT_TRUE(run("csv", "out.csv"));
  EXPECT_EQ(folder_.read("out.1.csv"), format_submap_csv(map_.submaps[1], false));
  ASSERT_TRUE(run("ply", "out.ply"));
  EXPECT_EQ(folder_.read("out.1.ply"), format_submap_ply(map_.submaps[1]));
}

TEST_F(ExportCommand, JsonHoldsThemAll) {
  ASSERT_TRUE(run("json", "out.json"));
  EXPECT_EQ(folder_.read("out.json"), format_map_json(map_));
  EXPECT_EQ(folder_.read("out.1.json"), "");
}

TEST_F(ExportCommand, WhatCannotBeDoneIsRefused) {
  EXPECT_EQ(run("xml", "out.xml").error().kind, ErrorKind::usage);
  EXPECT_EQ(run("json", "absent/out.json").error().kind, ErrorKind::cant_create);
  folder_.write("a.map", "damaged");
  folder_.write("out.tum", "earlier");
  EXPECT_EQ(run("tum", "out.tum").error().kind, ErrorKind::bad_data);
  EXPECT_EQ(folder_.read("out.tum"), "earlier");
}

TEST_F(ExportCommand, NothingTakesTheMapsPlace) {
  const std::string map = folder_.read("a.map");
  for (const char* format : {"tum", "csv", "ply", "json"}) {
    EXPECT_EQ(run(format, "a.map").error().kind, ErrorKind::usage) << format;
  }
  // The second sub-map's file.
  EXPECT_TRUE(write_map_file(folder_.path() / "b.1.map", map_));
  const auto second =
      run_export({folder_.path() / "b.1.map", "tum", folder_.path() / "b.map"}, notes_);
  EXPECT_EQ(second.error().kind, ErrorKind::usage);
  EXPECT_EQ(folder_.read("a.map"), map);
  EXPECT_EQ(folder_.read("b.1.map"), map);
  EXPECT_EQ(folder_.read("b.map"), "");
}

}  // namespace
}  // namespace waymark
