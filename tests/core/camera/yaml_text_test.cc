#include "core/camera/yaml_text.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "core/camera/kalibr.h"
#include "tests/support/peak_memory.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string message_of(const std::string& text) {
  const auto root = parse_yaml(text, "rig.yaml");
  return root ? "no error" : root.error().message;
}

TEST(YamlText, WhatIsNoYamlIsNamedWithItsLine) {
  EXPECT_EQ(message_of("a: 1\nb: [2, 3]\n"), "no error");
  EXPECT_THAT(message_of("a: 1\nb: [2, 3"), StartsWith("rig.yaml: line 2: not valid YAML"));
  EXPECT_EQ(parse_yaml("[", "rig.yaml").error().kind, ErrorKind::bad_data);
}

TEST(YamlText, MarksAreCountedBeforeAnythingIsParsed) {
  const std::string most(kMaxYamlMarks - 2, '\n');
  EXPECT_EQ(message_of(most + "a: 1\n"), "no error");
  EXPECT_THAT(message_of(most + "a: 1\n\n"), HasSubstr("32769 commas, brackets"));
}

TEST(YamlText, SizeIsBounded) {
  EXPECT_EQ(message_of(std::string(kMaxCamchainBytes, ' ')), "no error");
  EXPECT_THAT(message_of(std::string(kMaxCamchainBytes + 1, ' ')),
              StartsWith("rig.yaml: larger than 196608 bytes"));
}

/// `item` again and again between `begin` and `end`, as often as it is read.
std::string as_much_as_is_read(const std::string& begin, const std::string& item, char end) {
  const auto marks = [](const std::string& text) {
    return std::count_if(text.begin(), text.end(),
                         [](char c) { return c != ' ' && (c < '0' || c > '9') && c != 'a'; });
  };
  std::string text = begin;
  const auto each = static_cast<std::size_t>(marks(item));
  for (std::size_t taken = 8; taken + each < kMaxYamlMarks; taken += each) {
    if (text.size() + item.size() + 2 > kMaxCamchainBytes) break;
    text += item;
  }
  return text + end;
}

void expect_bounded(const std::string& text) {
  const std::size_t peak = test::peak_memory([&] { (void)parse_camchain(text, "rig.yaml"); });
  EXPECT_LT(peak, 50'000'000 + 20 * text.size()) << text.substr(0, 30);
  EXPECT_THAT(message_of(text), Not(HasSubstr("commas, brackets"))) << text.substr(0, 30);
}

// In lists and in maps: a key without a value is two values. Also as a camchain, whose reader asks
// it for its keys.
TEST(YamlText, NoTextTakesMoreThanFiftyMegabytesAndTwentyTimesItsLength) {
  for (const auto& [begin, end] : {std::pair{"cam0: {", '}'}, {"cam0: [", ']'}, {"{", '}'}}) {
    for (const char* item :
         {"0,",  "a,",      "[],",    "{},",    "[",     "{",   "a: 0,",   ":,",
          "? ,", "? a,",    "\"\",",  "!!a 0,", "&a 0,", "*a,", "[a: 0],", "a,\n",
          "'',", "a: {a},", "!<a> ,", "|\n",    "%\n",   "- "}) {
      expect_bounded(as_much_as_is_read(begin, item, end));
    }
  }
  for (const char* line : {"a:\n", "- a\n", "? a\n", "- - a\n", "-\n", "a: &a\n", "? ? a\n"}) {
    expect_bounded(as_much_as_is_read("", line, '\n'));
  }
}

}  // namespace
}  // namespace waymark
