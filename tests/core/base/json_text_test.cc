#include "core/base/json_text.h"

#include <gmock/gmock.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/temporary_folder.h"

namespace {
std::atomic<std::size_t> bytes_in_use{0};
std::atomic<std::size_t> most_in_use{0};

void* counted(void* block) {
  if (block == nullptr) throw std::bad_alloc();
  const std::size_t now = bytes_in_use += ::malloc_usable_size(block);
  if (now > most_in_use) most_in_use = now;
  return block;
}
}  // namespace

// The whole executable's, counted.
void* operator new(std::size_t size) { return counted(std::malloc(size)); }
void operator delete(void* block) noexcept {
  if (block != nullptr) bytes_in_use -= ::malloc_usable_size(block);
  std::free(block);
}
void operator delete(void* block, std::size_t /*size*/) noexcept { operator delete(block); }

namespace waymark {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::size_t kLimit = std::size_t{1} << 28;

std::string refusal(const std::string& text, std::size_t max_bytes = kLimit) {
  const auto document = parse_json(text, "x.json", max_bytes);
  if (document) return "accepted";
  EXPECT_EQ(document.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(document.error().message, StartsWith("x.json: "));
  return document.error().message;
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

TEST(JsonText, IsReadAsTheLibraryReadsIt) {
  for (const char* text :
       {"{}", "[]", "null", "true", "-3", "18446744073709551615", "1.5e-3", "\"a\\u00b5\\n\"",
        R"({"a": [1, [2.5, {"b": null}], "c"], "d": {"e": {"f": false}}, "g": []})"}) {
    const auto document = parse_json(text, "x.json", kLimit);
    ASSERT_TRUE(document) << document.error().message;
    EXPECT_EQ(*document, json::parse(text)) << text;
    EXPECT_EQ(document->dump(), json::parse(text).dump()) << text;
  }
}

TEST(JsonText, SaysWhereItIsNoJson) {
  EXPECT_THAT(refusal("{\n\"a\": 1,\n}"), HasSubstr("not valid JSON: parse error at line 3"));
  EXPECT_THAT(refusal(""), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal("{} {}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal("1e999"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal("[NaN]"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal("\"\xff\""), HasSubstr("not valid JSON"));
  EXPECT_LE(refusal("\"" + std::string(100'000, 'x')).size(), kMaxLineBytes);
}

TEST(JsonText, AMemberThatStandsThereTwiceIsRefused) {
  EXPECT_THAT(refusal(R"({"id": 1, "id": 2})"), HasSubstr("\"id\" stands there twice"));
  EXPECT_THAT(refusal(R"([{"a": {"id": 1, "b": 1, "id": 1}}])"), HasSubstr("\"id\" stands"));
}

TEST(JsonText, DepthIsBoundedBeforeAnythingRecurses) {
  const auto lists = [](std::size_t n) { return repeated("[", n) + repeated("]", n); };
  EXPECT_EQ(refusal(lists(kMaxJsonDepth)), "accepted");
  EXPECT_THAT(refusal(lists(kMaxJsonDepth + 1)), HasSubstr("nested deeper than 8 levels"));
  for (const char* level : {"[", "{\"a\":", "[{\"a\":"}) {
    EXPECT_THAT(refusal(repeated(level, 1'000'000)), HasSubstr("nested deeper than 8 levels"));
  }
}

TEST(JsonText, LargerThanAllowedIsRefused) {
  EXPECT_EQ(refusal("[1234567]", 9), "accepted");
  EXPECT_THAT(refusal("[12345678]", 9), HasSubstr("larger than 9 bytes"));
  const TemporaryFolder folder;
  EXPECT_TRUE(read_json(folder.write("x.json", "[1234567]"), 9));
  EXPECT_EQ(read_json(folder.write("x.json", "[12345678]"), 9).error().kind, ErrorKind::bad_data);
  EXPECT_EQ(read_json(folder.path() / "absent", 9).error().kind, ErrorKind::no_input);
}

TEST(JsonText, NoTextTakesMoreThanFiftyMegabytesAndTwentyTimesItsLength) {
  std::string names = "{";
  for (int i = 0; i < 600'000; ++i) names += fmt::format("\"{}\":0,", i);
  const std::string texts[] = {
      "[" + repeated("0,", 4'000'000) + "0]",
      "[" + repeated("[],", 3'000'000) + "0]",
      "[" + repeated("{},", 3'000'000) + "0]",
      "[" + repeated("\"\",", 3'000'000) + "0]",
      "[" + repeated("{\"a\":0},", 1'000'000) + "0]",
      "[[0],[" + repeated("[0],", 2'000'000) + "0]]",
      names + "\"\":0}",
      "[\"" + std::string(8'000'000, 'x') + "\"]",
      "[\"" + repeated("\\n", 4'000'000) + "\"]",
  };
  for (const std::string& text : texts) {
    const std::size_t before = bytes_in_use;
    most_in_use = before;
    (void)parse_json(text, "x.json", kLimit);
    EXPECT_LT(most_in_use - before, 50'000'000 + 20 * text.size()) << text.substr(0, 20);
  }
  EXPECT_THAT(refusal(texts[3]), HasSubstr("far more values than such a file holds"));
}

TEST(JsonText, ALargeMapIsNoAttack) {
  const std::string marker =
      R"({"id":7,"family":"tag36h11","size_m":0.2,"position_m":[1,2,0],"quaternion_xyzw":[0,0,0,1]})";
  EXPECT_EQ(refusal("[" + repeated(marker + ",", 100'000) + marker + "]"), "accepted");
  const std::string sure = marker.substr(0, marker.size() - 1) + ",\"covariance\":[" +
                           repeated("1e-07,", 35) + "1e-07]}";
  EXPECT_EQ(refusal("[" + repeated(sure + ",", 100'000) + sure + "]"), "accepted");
}

}  // namespace
}  // namespace waymark
