#include "core/base/one_line.h"

#include <gmock/gmock.h>

#include <random>
#include <string>

namespace waymark {
namespace {

TEST(InOneLine, SpellsOutWhatBreaksLinesAndTerminals) {
  EXPECT_EQ(in_one_line("pin\nhole\x1b[2J\t\x7f"), "pin\\nhole\\x1b[2J\\x09\\x7f");
}

TEST(InOneLine, LeavesTextAlone) {
  EXPECT_EQ(in_one_line("cam0: 30 Hz, größer als \\n"), "cam0: 30 Hz, größer als \\n");
  EXPECT_EQ(in_one_line("24 × 32 µm, 仓库, 🚗, \u00a0"), "24 × 32 µm, 仓库, 🚗, \u00a0");
}

TEST(InOneLine, SpellsOutControlCharactersOfUnicode) {
  EXPECT_EQ(in_one_line("\u0085\u009b31m"), "\\u0085\\u009b31m") << "8-bit line end and CSI";
  EXPECT_EQ(in_one_line("a\u2028b\u2029c"), "a\\u2028b\\u2029c");
  EXPECT_EQ(in_one_line("\u202etxt.exe\u2066\ufeff\u200b"), "\\u202etxt.exe\\u2066\\ufeff\\u200b");
  EXPECT_EQ(in_one_line(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(InOneLine, SpellsOutBytesThatAreNoUtf8) {
  EXPECT_EQ(in_one_line("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(in_one_line("caf\xe9"), "caf\\xe9") << "Latin 1, cut off";
  EXPECT_EQ(in_one_line("caf\xe9s"), "caf\\xe9s") << "Latin 1";
  EXPECT_EQ(in_one_line("\xc0\x8a"), "\\xc0\\x8a") << "a line end, overlong";
  EXPECT_EQ(in_one_line("\xe0\x80\x8a"), "\\xe0\\x80\\x8a") << "the same in three bytes";
  EXPECT_EQ(in_one_line("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "a surrogate";
  EXPECT_EQ(in_one_line("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
  EXPECT_EQ(in_one_line("\xe2\x82"), "\\xe2\\x82") << "the end is missing";
}

TEST(InOneLine, ALongTextKeepsBothEndsAndSaysHowLongItWas) {
  const std::string text =
      "unknown key " + std::string(131'462, 'a') + "; known: resolution, model";
  ASSERT_EQ(text.size(), 131'500U);
  const std::string line = in_one_line(text);
  EXPECT_LE(line.size(), kMaxLineBytes);
  EXPECT_GT(line.size(), kMaxLineBytes - 10);
  EXPECT_THAT(line, testing::StartsWith("unknown key aaa"));
  EXPECT_THAT(line, testing::HasSubstr("… (131,500 bytes) …"));
  EXPECT_THAT(line, testing::EndsWith("aaa; known: resolution, model"));
}

TEST(InOneLine, TheBoundIsHeldToTheByteAndNeverPartsACharacter) {
  const std::string fits(kMaxLineBytes, 'x');
  EXPECT_EQ(in_one_line(fits), fits);
  EXPECT_EQ(in_one_line(fits + "x").size(), kMaxLineBytes);
  for (std::size_t shift = 0; shift < 8; ++shift) {
    std::string text(shift, 'x');
    for (int i = 0; i < 300; ++i) text += "🚗µ";
    const std::string line = in_one_line(text);
    EXPECT_LE(line.size(), kMaxLineBytes);
    EXPECT_EQ(in_one_line(line), line) << "a character was parted, or the bound missed";
  }
}

TEST(InOneLine, ALineComesBackUnchanged) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::string noise(random() % 700, '\0');
    for (char& byte : noise) byte = static_cast<char>(random());
    const std::string line = in_one_line(noise);
    EXPECT_LE(line.size(), kMaxLineBytes);
    EXPECT_EQ(in_one_line(line), line);
    for (const char byte : line) {
      EXPECT_GE(static_cast<unsigned char>(byte), 0x20);
      EXPECT_NE(byte, 0x7f);
    }
  }
}

}  // namespace
}  // namespace waymark
