#include "mapbuilder/commands/diff_command.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/map/map_edit.h"
#include "core/map/map_file.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

class DiffCommand : public testing::Test {
 protected:
  DiffCommand() {
    EXPECT_TRUE(write_map_file(path("a.map"), test::small_map()));
    const auto renamed = edit_map(
        test::small_map(), "a.map",
        {{}, {{{Family::tag36h11, 12}, {Family::tag36h11, 13}}}, {{Family::tag36h11, 586}}});
    EXPECT_TRUE(write_map_file(path("b.map"), *renamed));
  }
  [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_.path() / name; }

  [[nodiscard]] Expected<std::string> diff(const char* from, const char* to,
                                           bool json = false) const {
    std::ostringstream out;
    const auto status = run_diff({path(from), path(to), json}, out);
    if (status) return out.str();
    EXPECT_EQ(out.str(), "");
    return tl::make_unexpected(status.error());
  }

  test::TemporaryFolder folder_;
};

TEST_F(DiffCommand, OneContentIsTheSameMapWhateverTheFile) {
  EXPECT_EQ(*diff("a.map", "a.map"), "the same map: " + content_hash(test::small_map()) + "\n");
}

TEST_F(DiffCommand, SaysWhatAnEditChanged) {
  EXPECT_THAT(*diff("a.map", "b.map"), HasSubstr("renamed        12 → 13\n"));
  const auto json = nlohmann::json::parse(*diff("a.map", "b.map", true));
  EXPECT_EQ(json["verified"], nlohmann::json({586}));
  EXPECT_EQ(json["renamed"][0]["to"], 13);
}

TEST_F(DiffCommand, AbsentDamagedAndIncomparableMapsEndInALine) {
  EXPECT_EQ(diff("a.map", "absent.map").error().kind, ErrorKind::no_input);
  folder_.write("c.map", "WAYMARK\n");
  EXPECT_EQ(diff("c.map", "a.map").error().kind, ErrorKind::bad_data);
  MarkerMap other = test::small_map();
  for (SubMap& submap : other.submaps) {
    for (MapMarker& marker : submap.markers) marker.id.family = Family::tag36h10;
  }
  ASSERT_TRUE(write_map_file(path("d.map"), other));
  EXPECT_EQ(diff("a.map", "d.map").error().kind, ErrorKind::bad_data);
}

}  // namespace
}  // namespace waymark
