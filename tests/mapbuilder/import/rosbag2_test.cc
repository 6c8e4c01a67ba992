#include "mapbuilder/import/rosbag2.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mapbuilder/import/bag_messages.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using test::any_topic;
using test::content_of;
using test::some_messages;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Rosbag2, AFoldersFilesAreThoseOfItsMetadata) {
  const TemporaryFolder folder;
  folder.write("bag/metadata.yaml",
               "rosbag2_bagfile_information:\n  version: 4\n  storage_identifier: sqlite3\n"
               "  relative_file_paths:\n    - bag/bag_0.db3\n    - ../../elsewhere/bag_1.db3\n");
  const auto files = files_of_recording(folder.path() / "bag");
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_THAT(*files, ElementsAre(folder.path() / "bag/bag_0.db3", folder.path() / "bag/bag_1.db3"))
      << "none of another folder";
  EXPECT_THAT(*files_of_recording("a.mcap"), ElementsAre("a.mcap"));
}

TEST(Rosbag2, FoldersThatAreNoneAreTold) {
  const TemporaryFolder folder;
  EXPECT_THAT(files_of_recording(folder.path()).error().message, HasSubstr("ros2 bag reindex"));
  for (const char* text : {"", "- 1\n", "rosbag2_bagfile_information: 3\n", "a: [b\n",
                           "rosbag2_bagfile_information: {relative_file_paths: []}\n",
                           "rosbag2_bagfile_information: {relative_file_paths: {a: b}}\n"}) {
    folder.write("metadata.yaml", text);
    const auto files = files_of_recording(folder.path());
    ASSERT_FALSE(files) << text;
    EXPECT_EQ(files.error().kind, ErrorKind::bad_data);
    EXPECT_THAT(files.error().message, HasSubstr("metadata.yaml"));
  }
}

TEST(Rosbag2, ReadsEitherStorage) {
  const TemporaryFolder folder;
  const auto mcap = folder.write("a.mcap", mcap_of(some_messages()));
  EXPECT_EQ(content_of(open_recorded(mcap, any_topic)).messages, some_messages());
  test::write_sqlite_bag(folder.path() / "a.db3", some_messages());
  EXPECT_EQ(content_of(open_recorded(folder.path() / "a.db3", any_topic)).messages,
            some_messages());
}

TEST(Rosbag2, MessagesThatArePackedOneByOneAreUnpacked) {
  const TemporaryFolder folder;
  std::vector<test::RecordedMessage> packed = some_messages();
  for (test::RecordedMessage& message : packed) message.data = test::zstd_of(message.data);
  test::write_sqlite_bag(folder.path() / "a.db3", packed);
  EXPECT_EQ(content_of(open_recorded(folder.path() / "a.db3", any_topic)).messages,
            some_messages());
  packed[1].data.resize(packed[1].data.size() - 3);
  const auto mcap = folder.write("a.mcap", mcap_of(packed));
  EXPECT_THAT(content_of(open_recorded(mcap, any_topic)).error, HasSubstr("a message of /tf"));
}

TEST(Rosbag2, OtherFilesAreToldWithWhatToDo) {
  const TemporaryFolder folder;
  const auto error_of = [&](std::string_view content) {
    const auto opened = open_recorded(folder.write("a", content), any_topic);
    EXPECT_FALSE(opened);
    return opened ? std::string() : opened.error().message;
  };
  EXPECT_THAT(error_of("#ROSBAG V2.0\n"), HasSubstr("rosbags-convert"));
  EXPECT_THAT(error_of("\x28\xB5\x2F\xFD"), HasSubstr("zstd -d"));
  EXPECT_THAT(error_of("text"), HasSubstr("neither MCAP nor SQLite"));
  EXPECT_EQ(open_recorded(folder.path() / "absent", any_topic).error().kind, ErrorKind::no_input);
}

}  // namespace
}  // namespace waymark
