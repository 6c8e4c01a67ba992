#include "core/base/line_reader.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

constexpr std::size_t kLongest = 400'000;

/// All lines of a file with this text; what is wrong comes last.
std::vector<std::string> lines_of(const std::string& text) {
  const test::TemporaryFolder folder;
  LineReader reader(*InputFile::open(folder.write("a.txt", text), 1U << 30), "a.txt", kLongest);
  std::vector<std::string> lines;
  for (;;) {
    const auto line = reader.next();
    if (!line) {
      lines.push_back(line.error().message);
      return lines;
    }
    if (!*line) return lines;
    lines.emplace_back(**line);
    EXPECT_EQ(reader.number(), lines.size());
  }
}

TEST(LineReader, GivesLinesWithoutTheirEndsAndTheLastOneWithoutAnEndToo) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of(""), Lines{});
  EXPECT_EQ(lines_of("\n"), Lines{""});
  EXPECT_EQ(lines_of("a\n\nbc"), (Lines{"a", "", "bc"}));
  EXPECT_EQ(lines_of("a\nbc\n"), (Lines{"a", "bc"}));
}

TEST(LineReader, LinesMayLieAcrossBlocks) {
  // A block is 262,144 bytes: each line begins in one and ends in another.
  const std::vector<std::string> lines{std::string(200'000, 'a'), std::string(200'000, 'b'),
                                       std::string(kLongest, 'c'), "d"};
  EXPECT_EQ(lines_of(lines[0] + "\n" + lines[1] + "\n" + lines[2] + "\n" + lines[3]), lines);
}

TEST(LineReader, ALineThatIsTooLongIsNamed) {
  const auto lines = lines_of("a\n" + std::string(kLongest + 1, 'b') + "\nc\n");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[1], "a.txt: line 2 has more than 400000 bytes; this is no such file");
}

}  // namespace
}  // namespace waymark
