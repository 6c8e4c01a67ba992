#include "mapbuilder/import/recorded_file.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

TEST(RecordedFile, IsToldByItsFirstBytes) {
  const TemporaryFolder folder;
  const auto kind = [&](std::string_view content) {
    return kind_of_file(folder.write("a", content)).value();
  };
  EXPECT_EQ(kind(""), RecordedFile::other);
  EXPECT_EQ(kind("{\"submaps\": []}"), RecordedFile::other);
  EXPECT_EQ(kind("\xED\xA1\xDA\x01 and more"), RecordedFile::lcm_log);
  EXPECT_EQ(kind("\x89MCAP0\r\n"), RecordedFile::mcap);
  EXPECT_EQ(kind("SQLite format 3"), RecordedFile::sqlite);
  EXPECT_EQ(kind("#ROSBAG V2.0\n"), RecordedFile::ros1_bag);
  EXPECT_EQ(kind("\x28\xB5\x2F\xFD"), RecordedFile::zstd);
  EXPECT_EQ(kind_of_file(folder.path() / "absent").error().kind, ErrorKind::no_input);
  EXPECT_FALSE(kind_of_file(folder.path()));
}

}  // namespace
}  // namespace waymark
