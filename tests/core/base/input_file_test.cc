#include "core/base/input_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/atomic_file.h"
#include "core/base/line_reader.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Of that many bytes, of which none was ever written behind `written`.
std::filesystem::path sparse_file(const TemporaryFolder& folder, std::string_view written,
                                  off_t size) {
  const auto path = folder.write("sparse", written);
  EXPECT_EQ(::truncate(path.c_str(), size), 0);
  return path;
}

TEST(InputFile, ReadsBlockByBlock) {
  const TemporaryFolder folder;
  auto file = InputFile::open(folder.write("a", "abcdef"), 100);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->size(), 6U);
  std::string block(4, ' ');
  EXPECT_EQ(file->read(block).value(), 4U);
  EXPECT_EQ(block, "abcd");
  EXPECT_EQ(file->read(block).value(), 2U);
  EXPECT_EQ(file->read(block).value(), 0U);
}

TEST(InputFile, WhatHasGrownBeyondTheLimitIsRefused) {
  const TemporaryFolder folder;
  auto file = InputFile::open(folder.write("a", "abc"), 4);
  ASSERT_TRUE(file);
  folder.write("a", "abcdef");
  std::string block(16, ' ');
  EXPECT_EQ(file->read(block).error().kind, ErrorKind::bad_data);
}

TEST(InputFile, SparseFilesAreRefusedAtOnceHoweverFewBytesTheyHave) {
  const TemporaryFolder folder;
  for (const off_t size : {off_t{2} << 20, off_t{1} << 31, off_t{5} << 40}) {
    for (const char* written : {"", "t_ns,camera\n"}) {
      const auto file = InputFile::open(sparse_file(folder, written, size), UINTMAX_MAX);
      ASSERT_FALSE(file) << size;
      EXPECT_EQ(file.error().kind, ErrorKind::bad_data);
      EXPECT_THAT(file.error().message, HasSubstr("sparse"));
    }
  }
  EXPECT_FALSE(read_file(sparse_file(folder, "", off_t{1} << 32)));
}

TEST(InputFile, AFewHolesAreNoHarm) {
  const TemporaryFolder folder;
  EXPECT_TRUE(InputFile::open(sparse_file(folder, "abc", 100'000), UINTMAX_MAX));
}

std::vector<std::string> lines_of(const TemporaryFolder& folder, std::string_view text) {
  LineReader lines(*InputFile::open(folder.write("lines", text), UINTMAX_MAX), "lines", 1000);
  std::vector<std::string> read;
  for (;;) {
    const auto line = lines.next();
    EXPECT_TRUE(line) << line.error().message;
    if (!line || !*line) return read;
    read.emplace_back(**line);
    EXPECT_EQ(lines.number(), read.size());
  }
}

TEST(LineReader, GivesEveryLineWithoutItsEnd) {
  const TemporaryFolder folder;
  EXPECT_THAT(lines_of(folder, ""), IsEmpty());
  EXPECT_THAT(lines_of(folder, "a"), ElementsAre("a"));
  EXPECT_THAT(lines_of(folder, "a\n"), ElementsAre("a"));
  EXPECT_THAT(lines_of(folder, "\na\r\n\n b"), ElementsAre("", "a\r", "", " b"));
}

TEST(LineReader, LinesMayStandAcrossBlocks) {
  const TemporaryFolder folder;
  std::string text;
  std::vector<std::string> expected;
  for (std::size_t i = 0; i < 3000; ++i) {
    expected.emplace_back(i * 7 % 1000, static_cast<char>('a' + i % 26));
    text += expected.back() + '\n';
  }
  EXPECT_EQ(lines_of(folder, text), expected);
}

TEST(LineReader, ALineTooLongIsRefusedWithItsNumber) {
  const TemporaryFolder folder;
  for (const std::size_t length : {1001, 300'000, 3'000'000}) {
    for (const char* end : {"", "\nb"}) {
      const auto path = folder.write("lines", "a\n" + std::string(length, 'x') + end);
      LineReader lines(*InputFile::open(path, UINTMAX_MAX), "file", 1000);
      ASSERT_TRUE(lines.next());
      const auto line = lines.next();
      ASSERT_FALSE(line) << length;
      EXPECT_EQ(line.error().kind, ErrorKind::bad_data);
      EXPECT_THAT(line.error().message, HasSubstr("file: line 2 has more than 1000 bytes"));
    }
  }
}

}  // namespace
}  // namespace waymark
