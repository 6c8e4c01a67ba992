#include "mapbuilder/import/mcap_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mapbuilder/import/bag_messages.h"
#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using test::any_topic;
using test::McapForm;
using test::some_messages;
using testing::HasSubstr;

test::BagContent read(std::string_view file, const WantsTopic& wants = any_topic) {
  const TemporaryFolder folder;
  return test::content_of(open_mcap(folder.write("a.mcap", file), wants));
}

/// Records in one chunk, between a header and an end.
std::string with_chunk(const std::string& records, const McapForm& form, std::uint64_t stated) {
  return std::string(test::kMcapMagic) + test::mcap_chunk(records, form, stated) +
         test::mcap_record(0x02, std::string(20, '\0')) + std::string(test::kMcapMagic);
}

TEST(McapReader, GivesTheMessagesOfEveryForm) {
  for (const char* compression : {"", "lz4", "zstd"}) {
    for (const std::size_t chunk : {1, 5, 100}) {
      for (const bool checksums : {true, false}) {
        const auto content =
            read(mcap_of(some_messages(), McapForm{compression, chunk, checksums}));
        EXPECT_EQ(content.error, "");
        EXPECT_EQ(content.messages, some_messages()) << compression << chunk;
      }
    }
  }
  EXPECT_EQ(read(mcap_of(some_messages(), McapForm{"", 0, true})).messages, some_messages());
}

TEST(McapReader, PassesOverWhatIsNotWanted) {
  const auto content =
      read(mcap_of(some_messages()), [](const BagTopic& topic) { return topic.name == "/right"; });
  EXPECT_EQ(content.messages.size(), 4U);
}

TEST(McapReader, EveryCutIsSaid) {
  const std::string whole = mcap_of(some_messages(), McapForm{"zstd", 3, true});
  for (std::size_t size = 0; size < whole.size(); size += size % 40 == 0 ? 1 : 13) {
    const auto content = read(std::string_view(whole).substr(0, size));
    ASSERT_NE(content.error, "") << size;
  }
  EXPECT_THAT(read(std::string_view(whole).substr(0, whole.size() - 1)).error,
              HasSubstr("truncated MCAP file"));
}

TEST(McapReader, AFlippedBitInAChunkIsSaid) {
  std::string file = mcap_of(some_messages(), McapForm{"", 100, true});
  file[file.find("left 2")] ^= 1;
  EXPECT_THAT(read(file).error, HasSubstr("checksum"));
}

TEST(McapReader, ChunksHoldWhatTheyState) {
  const std::string record = test::mcap_record(0x0C, "metadata");
  for (const char* compression : {"lz4", "zstd"}) {
    const McapForm form{compression, 1, false};
    EXPECT_EQ(read(with_chunk(record, form, record.size())).error, "");
    EXPECT_THAT(read(with_chunk(record, form, record.size() + 1)).error, HasSubstr("damaged"));
  }
  EXPECT_THAT(read(with_chunk(record, {"", 1, false}, record.size() + 1)).error,
              HasSubstr("a chunk's size"));
  const std::string nested = test::mcap_chunk(record, {"", 1, false}, record.size());
  EXPECT_THAT(read(with_chunk(nested, {"", 1, false}, nested.size())).error,
              HasSubstr("a chunk within a chunk"));
  EXPECT_THAT(read(with_chunk(record, {"brotli", 1, false}, record.size())).error,
              HasSubstr("\"brotli\", which is not known"));
}

TEST(McapReader, UnpacksNoMoreThanItsLimit) {
  const TemporaryFolder folder;
  const std::string file = with_chunk("", {"zstd", 1, false}, 0);
  const std::uint64_t most = BagLimits::most_unpacked(file.size());
  EXPECT_THAT(read(with_chunk("", {"zstd", 1, false}, most)).error, HasSubstr("holds less"));
  EXPECT_THAT(read(with_chunk("", {"zstd", 1, false}, most + 1)).error,
              HasSubstr("it unpacks to more than"));
}

TEST(McapReader, AMessageIsNoLargerThanItsLimit) {
  const auto file_of = [](std::size_t bytes) {
    return test::mcap_of({{"/left", "sensor_msgs/msg/Image", std::string(bytes, 'x')}},
                         McapForm{"zstd", 1, true});
  };
  const std::size_t limit = BagLimits::largest_message(file_of(24'000'000).size());
  EXPECT_EQ(read(file_of(limit - 1000)).error, "");
  const TemporaryFolder folder;
  const auto path = folder.write("a.mcap", file_of(60'000'000));
  std::string refused;
  const std::size_t memory =
      test::peak_memory([&] { refused = test::content_of(open_mcap(path, any_topic)).error; });
  EXPECT_THAT(refused, HasSubstr("a message of 60000000 bytes"));
  EXPECT_LT(memory, 40'000'000U);
}

TEST(McapReader, TopicsAreCountedAndNamed) {
  std::vector<test::RecordedMessage> messages(4096, {"", "t", "x"});
  for (std::size_t i = 0; i < messages.size(); ++i) messages[i].topic = std::to_string(i);
  EXPECT_EQ(read(mcap_of(messages)).error, "");
  messages.push_back({"one more", "t", "x"});
  EXPECT_THAT(read(mcap_of(messages)).error, HasSubstr("too many"));
  EXPECT_EQ(read(test::mcap_of({{std::string(256, 'n'), "t", "x"}})).error, "");
  EXPECT_THAT(read(test::mcap_of({{std::string(257, 'n'), "t", "x"}})).error, HasSubstr("name"));
}

TEST(McapReader, AnotherVersionIsSaid) {
  EXPECT_THAT(read("\x89MCAP1\r\n and more").error, HasSubstr("not an MCAP file of version 0"));
}

}  // namespace
}  // namespace waymark
