#include "mapbuilder/import/sqlite_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mapbuilder/import/bag_messages.h"
#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using test::any_topic;
using test::content_of;
using test::some_messages;
using testing::HasSubstr;

constexpr std::string_view kTopic =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
    "INSERT INTO topics VALUES (1, '/left', 'sensor_msgs/msg/Image', 'cdr');";

class SqliteBagTest : public testing::Test {
 protected:
  /// Of a database with one topic, and what else is made of it.
  test::BagContent read_beside_topic(std::string_view statements) {
    return read(fmt::format("{}{}", kTopic, statements));
  }

  test::BagContent read(const std::string& statements) {
    const auto path = folder_.path() / "a.db3";
    std::filesystem::remove(path);
    test::write_sqlite(path, statements);
    return content_of(open_sqlite_bag(path, any_topic));
  }

  const TemporaryFolder folder_;
};

TEST_F(SqliteBagTest, GivesTheMessagesInTheirOrder) {
  const auto path = folder_.path() / "a ?#%.db3";
  test::write_sqlite_bag(path, some_messages());
  const auto content = content_of(open_sqlite_bag(path, any_topic));
  EXPECT_EQ(content.error, "");
  EXPECT_EQ(content.messages, some_messages());
  const auto right = content_of(
      open_sqlite_bag(path, [](const BagTopic& topic) { return topic.name == "/right"; }));
  EXPECT_EQ(right.messages.size(), 4U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1)
      << "nothing is written beside it";
}

TEST_F(SqliteBagTest, CutsAndDamageAreSaid) {
  const auto path = folder_.path() / "a.db3";
  std::vector<test::RecordedMessage> messages = some_messages();
  messages[2].data = std::string(100'000, 'r');
  test::write_sqlite_bag(path, messages);
  const std::string whole = folder_.read("a.db3");
  for (const std::size_t size : {100UL, 4096UL, 20'000UL, whole.size() - 4096}) {
    const auto cut = folder_.write("cut.db3", whole.substr(0, size));
    EXPECT_THAT(content_of(open_sqlite_bag(cut, any_topic)).error,
                HasSubstr("damaged or truncated database"))
        << size;
  }
}

TEST_F(SqliteBagTest, OtherDatabasesAreTold) {
  EXPECT_THAT(read("CREATE TABLE other(id)").error, HasSubstr("no recording of rosbag2"));
  EXPECT_THAT(read_beside_topic("CREATE TABLE messages(id INTEGER PRIMARY KEY)").error,
              HasSubstr("damaged or truncated"));
}

TEST_F(SqliteBagTest, NothingIsComputed) {
  EXPECT_THAT(
      read_beside_topic(
          "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
          "SELECT i AS id, 1 AS topic_id, zeroblob(1000000) AS data FROM n")
          .error,
      HasSubstr("no recording of rosbag2"));
  EXPECT_THAT(read_beside_topic(
                  "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, data BLOB AS "
                  "(zeroblob(900000000))); INSERT INTO messages(topic_id) VALUES (1)")
                  .error,
              HasSubstr("no recording of rosbag2"));
}

TEST_F(SqliteBagTest, NamesAreBounded) {
  const auto with_name = [&](std::size_t size) {
    return read(
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, data);"
               "INSERT INTO topics VALUES (1, '" +
               std::string(size, 'n') + "', 't', 'cdr')")
        .error;
  };
  EXPECT_EQ(with_name(256), "");
  EXPECT_THAT(with_name(257), HasSubstr("name is too long"));
}

TEST_F(SqliteBagTest, AJournalThatWasNotWrittenBackIsSaid) {
  const auto path = folder_.path() / "a.db3";
  test::write_sqlite_bag(path, some_messages());
  folder_.write("a.db3-wal", "");
  EXPECT_EQ(content_of(open_sqlite_bag(path, any_topic)).error, "");
  folder_.write("a.db3-wal", "more");
  EXPECT_THAT(content_of(open_sqlite_bag(path, any_topic)).error, HasSubstr("did not end"));
}

}  // namespace
}  // namespace waymark
