#include "mapbuilder/import/byte_source.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

std::string counted(std::size_t size) {
  std::string text(size, '\0');
  for (std::size_t i = 0; i < size; ++i) text[i] = static_cast<char>(i * 7);
  return text;
}

TEST(ByteSource, GivesAFileInPiecesOfAnySize) {
  const TemporaryFolder folder;
  const std::string content = counted(200'001);
  FileSource source(InputFile::open(folder.write("a", content), 1 << 20).value());
  std::string got;
  std::vector<std::uint8_t> buffer;
  for (std::size_t size = 1; got.size() < content.size(); size = size * 3 + 1) {
    buffer.resize(size);
    const auto count = source.read(buffer);
    ASSERT_TRUE(count);
    got.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
    EXPECT_EQ(source.position(), got.size());
  }
  EXPECT_EQ(got, content);
  EXPECT_EQ(*source.read(buffer), 0U);
}

TEST(ByteSource, APartEndsWhereItIsSaidTo) {
  const TemporaryFolder folder;
  FileSource whole(InputFile::open(folder.write("a", "abcdef"), 100).value());
  PartSource part(whole, 4);
  std::array<std::uint8_t, 3> buffer{};
  EXPECT_TRUE(*read_whole(part, buffer));
  EXPECT_FALSE(*read_whole(part, buffer)) << "one byte is left";
  EXPECT_EQ(part.left(), 0U);
  EXPECT_TRUE(*pass_over(whole, 1));
  EXPECT_FALSE(*pass_over(whole, 2)) << "only f is left";
}

}  // namespace
}  // namespace waymark
