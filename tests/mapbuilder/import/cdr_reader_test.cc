#include "mapbuilder/import/cdr_reader.h"

#include <gtest/gtest.h>

#include "tests/support/recordings.h"

namespace waymark {
namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};  // NOLINT: bytes
}

class CdrReaderTest : public testing::TestWithParam<bool> {};

TEST_P(CdrReaderTest, NumbersLieAtMultiplesOfTheirSize) {
  test::Cdr cdr(GetParam());
  cdr.number(std::uint8_t{7}).number(std::uint32_t{70'000}).text("ab").number(2.5).bytes("xyz");
  const std::string message = cdr.number(std::int16_t{-3}).str();
  auto in = CdrReader::open(bytes_of(message));
  ASSERT_TRUE(in);
  EXPECT_EQ(in->number<std::uint8_t>(), 7);
  EXPECT_EQ(in->number<std::uint32_t>(), 70'000U);
  EXPECT_EQ(in->text(), "ab");
  EXPECT_EQ(in->number<double>(), 2.5);
  EXPECT_EQ(in->bytes().size(), 3U);
  EXPECT_EQ(in->number<std::int16_t>(), -3);
  EXPECT_EQ(in->left(), 0U);
  EXPECT_FALSE(in->failed());
  EXPECT_EQ(in->text(), "");
  EXPECT_TRUE(in->failed());
}

INSTANTIATE_TEST_SUITE_P(ByteOrders, CdrReaderTest, testing::Bool());

TEST(CdrReader, OtherEncodingsAreTold) {
  EXPECT_FALSE(CdrReader::open({}));
  EXPECT_FALSE(CdrReader::open(bytes_of(std::string("\0\2\0\0", 4)))) << "a parameter list";
  EXPECT_FALSE(CdrReader::open(bytes_of("text")));
}

}  // namespace
}  // namespace waymark
