#include "core/base/toml_text.h"

#include <gmock/gmock.h>

#include <ctime>

#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(TomlText, ParsesWithByteOrderMarkAndCrlf) {
  const auto table = parse_toml("\xEF\xBB\xBFsize = 3\r\nname = \"a\"\r\n", "x.toml");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ((*table)["size"].value<int>(), 3);
  EXPECT_EQ((*table)["name"].value<std::string>(), "a");
}

TEST(TomlText, SyntaxErrorNamesFileAndLine) {
  const auto table = parse_toml("a = 1\nb = = 2\n", "x.toml");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(table.error().message, HasSubstr("x.toml: line 2: not valid TOML"));
  EXPECT_EQ(table.error().message.find('\n'), std::string::npos);
  EXPECT_EQ(parse_toml("a = ", "locd.toml", ErrorKind::config).error().kind, ErrorKind::config);
}

TEST(TomlText, BinaryInputFailsCleanly) {
  EXPECT_FALSE(parse_toml(std::string_view("\0\x01\xFF", 3), "x.toml"));
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

/// Every way in which TOML nests, `levels` deep.
std::vector<std::string> nested(std::size_t levels) {
  const std::string dotted = "a" + repeated(".a", levels);
  return {dotted + " = 1\n",
          "[" + dotted + "]\n",
          "[[" + dotted + "]]\n",
          "a" + repeated(" . a", levels) + " = 1\n",
          "\"a\"" + repeated(".'=\"'.\"#\\\"\"", levels / 2) + " = 1\n",
          "x = [\"\"\"text\"\"\"\", {" + dotted + " = 1}]\n",
          "x = ['\\', {" + dotted + " = 1}]\n",
          "x = " + repeated("[", levels) + repeated("]", levels) + "\n",
          "x = " + repeated("[", levels),
          "x = " + repeated("[\n", levels),
          "x = " + repeated("{a = ", levels) + "1" + repeated("}", levels) + "\n",
          "x = " + repeated("[{a = ", levels / 2) + "1" + repeated("}]", levels / 2) + "\n",
          "x = " + repeated("{a.a.a.a.a.a = ", levels) + "1" + repeated("}", levels) + "\n"};
}

TEST(TomlText, WhatNestsTooDeepIsRefusedBeforeItIsParsed) {
  for (const std::size_t levels : {40, 1'000, 30'000, 500'000, 1'000'000}) {
    for (const std::string& text : nested(levels)) {
      const auto table = parse_toml("first = 1\n" + text, "x.toml", ErrorKind::config);
      ASSERT_FALSE(table) << text.substr(0, 40);
      EXPECT_EQ(table.error().kind, ErrorKind::config);
      EXPECT_THAT(table.error().message, testing::StartsWith("x.toml: "));
    }
  }
  EXPECT_EQ(
      parse_toml("first = 1\n" + nested(20).front(), "x.toml").error().message,
      "x.toml: line 2: nested deeper than 16 levels, or more than 65536 dots; this is not such a "
      "file");
}

TEST(TomlText, WhatNestsAsDeepAsAllowedIsTaken) {
  const int levels = kMaxTomlDepth;
  EXPECT_TRUE(parse_toml("a" + repeated(".a", levels) + " = 1\n", "x.toml"));
  EXPECT_FALSE(parse_toml("a" + repeated(".a", levels + 1) + " = 1\n", "x.toml"));
  EXPECT_TRUE(parse_toml("a = " + repeated("[", levels) + repeated("]", levels), "x.toml"));
  EXPECT_FALSE(
      parse_toml("a = " + repeated("[", levels + 1) + repeated("]", levels + 1), "x.toml"));
}

TEST(TomlText, DotsAndBracketsInTextsNumbersAndCommentsNestNothing) {
  const auto table = parse_toml(
      "# [[[[[[[[[[[[[[[[[[[[ a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a\n"
      "path = \"../../../../../../../../../[[[[[[[[[[[[[[[[[[[[\"\n"
      "literal = '\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.\\.'\n"
      "lines = \"\"\"\n....................\n\\\"\"\"[[[[[[[[[[[[[[[[[[[[\"\"\"\"\"\n"
      "numbers = [1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, "
      "1.5, 1.5, 1.5, 1.5]\n" +
          repeated("[[blocks]]\nsize = 1.5\n", 100),
      "x.toml");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ((*table)["blocks"].as_array()->size(), 100U);
}

TEST(TomlText, LargerThanAMebibyteIsRefused) {
  std::string text = "a = 1\n#";
  text += std::string(kMaxTomlBytes - text.size(), '.');
  EXPECT_TRUE(parse_toml(text, "x.toml"));
  EXPECT_FALSE(parse_toml(text + ".", "x.toml"));
  const TemporaryFolder folder;
  EXPECT_TRUE(read_toml(folder.write("x.toml", text)));
  EXPECT_FALSE(read_toml(folder.write("x.toml", text + ".")));
}

/// As many lines as fit, each with a number between `before` and `behind`.
std::string numbered(const std::string& before, const std::string& behind, std::size_t bytes) {
  std::string text;
  for (int i = 0; text.size() + 64 < bytes; ++i) text += before + std::to_string(i) + behind;
  return text;
}

TEST(TomlText, DotsAreCounted) {
  const std::string line = "x = [" + repeated("0.5, ", 64) + "]\n";
  std::string text;
  for (int i = 0; i < 1024; ++i) text += "a" + std::to_string(i) + line;
  EXPECT_TRUE(parse_toml(text, "x.toml"));
  EXPECT_FALSE(parse_toml(text + "b = 0.5\n", "x.toml"));
}

TEST(TomlText, NoTextTakesMoreThanFiftyMegabytesAndTwentyTimesItsLength) {
  constexpr std::size_t kRoom = kMaxTomlBytes - 100;
  const std::string parts = repeated(".a", 14) + "=0\n";
  const std::string texts[] = {
      "x = [" + repeated("0,", kRoom / 2) + "]\n",
      "x = [" + repeated("[],", kRoom / 3) + "]\n",
      "x = [" + repeated("{},", kRoom / 3) + "]\n",
      "x = [" + repeated(repeated("{a=", 15) + "0" + repeated("}", 15) + ",", kRoom / 62) + "]\n",
      repeated("[[a]]\n", kRoom / 6),
      numbered("k", "=0\n", kRoom),
      numbered("[k", "]\n", kRoom),
      numbered("k", parts, kRoom),
      numbered("k", parts, kRoom / 8) + "x = [" + repeated("{},", kRoom / 4) + "]\n",
      "x = \"" + repeated("\\n", kRoom / 2) + "\"\n",
  };
  for (const std::string& text : texts) {
    const std::size_t peak = test::peak_memory([&] { (void)parse_toml(text, "x.toml"); });
    EXPECT_LT(peak, 50'000'000 + 20 * text.size()) << text.substr(0, 40);
  }
}

double cpu_s(const std::string& text) {
  const std::clock_t begin = std::clock();
  (void)parse_toml(text, "x.toml");
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

TEST(TomlText, NoQuotesTakeMoreThanASecondAndAMicrosecondPerByte) {
  for (const std::string part : {"'", "\"", "'''", "\"\"\"", "'' ", "\\\"", "'\n", "#'\n",
                                 "''''''''\"\"\"\"\"\"\"\"", "''''''a", "'''\n'''"}) {
    for (const std::string before : {"", "x = ", "x = [", "# a\nx = {a = "}) {
      const std::string text = before + repeated(part, (kMaxTomlBytes - 64) / part.size());
      EXPECT_LT(cpu_s(text), 1 + 1e-6 * static_cast<double>(text.size())) << before << part;
    }
  }
}

TEST(TomlText, AbsentFileIsNoInput) {
  const TemporaryFolder folder;
  const auto table = read_toml(folder.path() / "absent.toml");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().kind, ErrorKind::no_input);
  EXPECT_THAT(table.error().message, HasSubstr("absent.toml"));
}

TEST(TomlText, UnknownKeyIsNamedWithItsLine) {
  const auto table = parse_toml("size = 3\nsizee = 4\n", "x.toml");
  ASSERT_TRUE(table);
  EXPECT_TRUE(check_toml_keys(*table, {"size", "sizee"}, "x.toml"));
  const auto status = check_toml_keys(*table, {"size", "name"}, "x.toml");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message,
            "x.toml: line 2: unknown key \"sizee\"; known here: size, name");
}

}  // namespace
}  // namespace waymark
