#include "mapbuilder/commands/import_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

Status import(const ImportOptions& options, std::ostream& out) {
  Progress progress(false);
  std::ostringstream notes;
  return run_import(options, progress, out, notes);
}

TEST(ImportCommand, MakesTheMapThatWasExported) {
  const test::TemporaryFolder folder;
  std::ostringstream out;
  const auto json = folder.write("map.json", format_map_json(test::small_map()));
  const auto status = import({json, folder.path() / "a.map", {}, {}, {}, {}}, out);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(folder.read("a.map"), *encode_map(test::small_map()));
  EXPECT_THAT(out.str(),
              EndsWith(": 5 markers, content hash " + content_hash(test::small_map()) + "\n"));
}

TEST(ImportCommand, BadInputLeavesTheEarlierMap) {
  const test::TemporaryFolder folder;
  folder.write("a.map", "earlier");
  std::ostringstream out;
  const auto bad =
      import({folder.write("map.json", "{}"), folder.path() / "a.map", {}, {}, {}, {}}, out);
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(bad.error().message, HasSubstr("map.json"));
  const auto absent =
      import({folder.path() / "absent.json", folder.path() / "a.map", {}, {}, {}, {}}, out);
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::no_input);
  EXPECT_EQ(folder.read("a.map"), "earlier");
  EXPECT_EQ(out.str(), "");
}

TEST(ImportCommand, TakesOptionsOnlyForWhatTheyAreFor) {
  const test::TemporaryFolder folder;
  std::ostringstream out;
  const auto json = folder.write("map.json", format_map_json(test::small_map()));
  const auto log = folder.write("a.lcm", "\xED\xA1\xDA\x01");
  const auto bag = folder.write("a.mcap", "\x89MCAP0\r\n");
  const auto output = folder.path() / "output";
  for (const ImportOptions& wrong :
       std::vector<ImportOptions>{{json, output, {log, {}}, {}, {}, {}},
                                  {json, output, {}, {"/image"}, {}, {}},
                                  {json, output, {}, {}, 2, {}},
                                  {json, output, {}, {}, {}, "D"},
                                  {log, output, {}, {"/image"}, {}, {}},
                                  {log, output, {}, {}, 2, {}},
                                  {bag, output, {}, {}, {}, "D"}}) {
    const auto refused = import(wrong, out);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::usage) << refused.error().message;
  }
  EXPECT_FALSE(std::filesystem::exists(output));
}

}  // namespace
}  // namespace waymark
