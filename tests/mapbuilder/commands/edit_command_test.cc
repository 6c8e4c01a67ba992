#include "mapbuilder/commands/edit_command.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "core/map/map_file.h"
#include "core/map/marker_search.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

MarkerId id(int number) { return {Family::tag36h11, number}; }

class EditCommand : public testing::Test {
 protected:
  EditCommand() { EXPECT_TRUE(write_map_file(path("a.map"), test::small_map())); }

  [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_.path() / name; }

  [[nodiscard]] Status edit(EditOptions options) {
    options.map = path("a.map");
    if (options.output.empty()) options.output = path("b.map");
    return run_edit(options, out_, notes_);
  }

  test::TemporaryFolder folder_;
  std::ostringstream out_;
  std::ostringstream notes_;
};

TEST_F(EditCommand, TakesRangesRenamesAndAccepts) {
  ASSERT_TRUE(edit({{}, {}, {"0-0, 12"}, {"3=30", "7=70"}, {"586"}}));
  const auto map = read_map_file(path("b.map"));
  ASSERT_TRUE(map);
  EXPECT_EQ(marker_ids(*map), (std::vector{id(30), id(70), id(586)}));
  EXPECT_THAT(out_.str(), HasSubstr("b.map: 3 markers, 2 removed, 2 renamed, 1 accepted"));
  EXPECT_THAT(out_.str(), HasSubstr("before " + content_hash(test::small_map())));
  EXPECT_EQ(notes_.str(), "");
}

TEST_F(EditCommand, ReplacesTheMapItselfWholeOrNotAtAll) {
  EditOptions options{{}, path("a.map"), {"3,9"}, {}, {}};
  const auto refused = edit(options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(refused.error().message, HasSubstr("no marker 9 in it"));
  EXPECT_EQ(content_hash(*read_map_file(path("a.map"))), content_hash(test::small_map()));
  options.remove = {"3"};
  ASSERT_TRUE(edit(options));
  EXPECT_EQ(marker_ids(*read_map_file(path("a.map"))).size(), 4U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(EditCommand, WhatChangesNothingLeavesAQuarantineAsItIs) {
  MarkerMap map = test::small_map();
  for (MapMarker& marker : map.submaps.front().markers) marker.verified = true;
  ASSERT_TRUE(write_map_file(path("a.map"), map));
  ASSERT_TRUE(edit({{}, {}, {}, {}, {"3"}}));
  EXPECT_EQ(content_hash(*read_map_file(path("b.map"))), content_hash(map));
  EXPECT_THAT(out_.str(), HasSubstr("map " + content_hash(map) + " as before"));
  EXPECT_THAT(out_.str(), testing::Not(HasSubstr("does not hold")));
}

TEST_F(EditCommand, SaysWhichWereVerifiedBefore) {
  ASSERT_TRUE(edit({{}, {}, {}, {}, {"3,586"}}));
  EXPECT_EQ(notes_.str(), "note: verified before: 3\n");
}

TEST_F(EditCommand, RefusesAndWritesNothing) {
  const auto kind = [&](EditOptions options) {
    const auto status = edit(std::move(options));
    EXPECT_FALSE(status);
    return status ? ErrorKind::internal : status.error().kind;
  };
  EXPECT_EQ(kind({}), ErrorKind::usage);
  EXPECT_EQ(kind({{}, {}, {}, {"3"}, {}}), ErrorKind::usage);
  EXPECT_EQ(kind({{}, {}, {}, {"3=tag16h5:4"}, {}}), ErrorKind::usage);
  EXPECT_EQ(kind({{}, {}, {"x"}, {}, {}}), ErrorKind::bad_data);
  EXPECT_EQ(kind({{}, {}, {"0-586"}, {}, {}}), ErrorKind::bad_data);
  EXPECT_EQ(kind({{}, {}, {"0,3,7,12,586"}, {}, {}}), ErrorKind::bad_data);
  EXPECT_EQ(kind({{}, {}, {}, {"3=12"}, {}}), ErrorKind::bad_data);
  EXPECT_EQ(kind({{}, path("absent/b.map"), {"3"}, {}, {}}), ErrorKind::cant_create);
  EXPECT_FALSE(std::filesystem::exists(path("b.map")));
  EXPECT_EQ(out_.str(), "");
}

}  // namespace
}  // namespace waymark
