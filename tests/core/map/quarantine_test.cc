#include "core/map/quarantine.h"

#include <gtest/gtest.h>

#include "core/map/map_file.h"
#include "tests/support/small_map.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

TEST(Quarantine, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "quarantine.json";
  Quarantine quarantine{"0123456789abcdef",
                        {{{Family::tag36h11, 7}, QuarantineState::unknown, 5, 0},
                         {{Family::tag36h11, 9}, QuarantineState::ignored, 6, 0},
                         {{Family::aruco_4x4_50, 3}, QuarantineState::moved, 1234567, 0.25}}};
  ASSERT_TRUE(write_quarantine(path, quarantine));
  const auto read = read_quarantine(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->map_hash, quarantine.map_hash);
  ASSERT_EQ(read->markers.size(), 3U);
  EXPECT_EQ(read->markers[0].marker, (MarkerId{Family::aruco_4x4_50, 3}));
  EXPECT_EQ(read->markers[0].state, QuarantineState::moved);
  EXPECT_EQ(read->markers[0].since_utime, 1234567);
  EXPECT_EQ(read->markers[0].offset_m, 0.25);
  EXPECT_EQ(read->markers[1].state, QuarantineState::unknown);
  EXPECT_EQ(read->markers[2].state, QuarantineState::ignored);
}

TEST(Quarantine, HasTheFormOfTheFormat) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "q.json";
  ASSERT_TRUE(write_quarantine(
      path, {"00000000000000ff", {{{Family::tag36h11, 12}, QuarantineState::moved, 1, 0.5}}}));
  EXPECT_EQ(folder.read("q.json"),
            "{\n \"map_hash\": \"00000000000000ff\",\n \"markers\": [\n  {\n   \"id\": 12,\n   "
            "\"family\": \"tag36h11\",\n   \"state\": \"MOVED\",\n   \"since_utime\": 1,\n   "
            "\"offset_m\": 0.5\n  }\n ]\n}\n");
}

TEST(Quarantine, RefusesWhatIsNone) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_quarantine(folder.path() / "absent").error().kind, ErrorKind::no_input);
  for (
      const char* text :
      {"",
       "{",
       "[]",
       "{\"map_hash\": 5, \"markers\": []}",
       "{\"map_hash\": \"a\"}",
       R"({"map_hash":"a","markers":[{"id":4294967308,"family":"tag36h11","state":"MOVED","since_utime":0,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":12.7,"family":"tag36h11","state":"MOVED","since_utime":0,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":-1,"family":"tag36h11","state":"MOVED","since_utime":0,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":"tag36h11:3","family":"aruco_4x4_50","state":"MOVED","since_utime":0,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":3,"family":"tag36h11","state":"MOVED","since_utime":-1,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":3,"family":"tag36h11","state":"MOVED","since_utime":1.5,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":3,"family":"tag36h11","state":"MOVED","since_utime":1,"offset_m":0,"why":"x"}]})",
       R"({"map_hash":"a","markers":[{"id":3,"family":"tag36h11","state":"MOVED","since_utime":1,"offset_m":1e300}]})",
       R"({"map_hash":"a","markers":[{"id":3,"family":"tag36h11","state":"MOVED","since_utime":1,"offset_m":0},{"id":3,"family":"tag36h11","state":"MOVED","since_utime":1,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[],"version":2})",
       R"({"map_hash":"a","markers":[[[[[[[[[[]]]]]]]]]})",
       R"({"map_hash":"a","markers":[{"id":1,"family":"none","state":"MOVED","since_utime":0,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":999999,"family":"tag36h11","state":"MOVED","since_utime":0,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":1,"family":"tag36h11","state":"GONE","since_utime":0,"offset_m":0}]})",
       R"({"map_hash":"a","markers":[{"id":1,"family":"tag36h11","state":"MOVED","since_utime":0,"offset_m":-1}]})"}) {
    const auto path = folder.write("bad.json", text);
    const auto read = read_quarantine(path);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().kind, ErrorKind::bad_data) << text;
    EXPECT_NE(read.error().message.find("bad.json"), std::string::npos);
  }
}

TEST(Quarantine, AbsentIsNotDamaged) {
  const TemporaryFolder folder;
  const auto absent = read_quarantine_if_any(folder.path() / "absent.json");
  ASSERT_TRUE(absent) << absent.error().message;
  EXPECT_FALSE(absent->has_value());
  const auto path = folder.write("q.json", R"({"map_hash":"a","markers":[]})");
  const auto there = read_quarantine_if_any(path);
  ASSERT_TRUE(there) << there.error().message;
  ASSERT_TRUE(there->has_value());
  EXPECT_EQ((*there)->map_hash, "a");
  folder.write("q.json", "{\"map_hash\":");
  EXPECT_EQ(read_quarantine_if_any(path).error().kind, ErrorKind::bad_data);
  std::filesystem::remove(path);
  std::filesystem::create_symlink(folder.path() / "absent", path);
  EXPECT_FALSE(read_quarantine_if_any(path)) << "a dangling link is something";
  std::filesystem::remove(path);
  std::filesystem::create_directory(path);
  EXPECT_FALSE(read_quarantine_if_any(path)) << "so is a folder";
}

TEST(Quarantine, LargerThanAMegabyteIsNone) {
  const std::string text = R"({"map_hash":"a","markers":[]})";
  const std::string most = text + std::string((std::size_t{1} << 20) - text.size(), ' ');
  EXPECT_TRUE(parse_quarantine(most, "q.json"));
  EXPECT_FALSE(parse_quarantine(most + " ", "q.json"));
}

TEST(Quarantine, OfAnotherMapIsSaidToBe) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "q.json";
  const MarkerMap map = test::small_map();
  ASSERT_TRUE(write_quarantine(path, {content_hash(map), {}}));
  EXPECT_TRUE(read_quarantine_of(path, map, "hall.map"));
  ASSERT_TRUE(write_quarantine(path, {"00000000000000ff", {}}));
  const auto foreign = read_quarantine_of(path, map, "hall.map");
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().kind, ErrorKind::bad_data);
  for (const std::string& part : {std::string("00000000000000ff"), content_hash(map),
                                  std::string("hall.map"), std::string("q.json")}) {
    EXPECT_NE(foreign.error().message.find(part), std::string::npos) << foreign.error().message;
  }
}

}  // namespace
}  // namespace waymark
