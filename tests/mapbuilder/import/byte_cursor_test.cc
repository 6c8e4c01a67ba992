#include "mapbuilder/import/byte_cursor.h"

#include <gtest/gtest.h>

#include <array>

namespace waymark {
namespace {

constexpr std::array<std::uint8_t, 8> kBytes{1, 2, 3, 4, 'a', 'b', 0xFF, 0xFE};

TEST(ByteCursor, ReadsEitherByteOrder) {
  ByteCursor little(kBytes, std::endian::little);
  EXPECT_EQ(little.number<std::uint32_t>(), 0x04030201U);
  EXPECT_EQ(little.text(2), "ab");
  EXPECT_EQ(little.number<std::int16_t>(), -257);
  ByteCursor big(kBytes, std::endian::big);
  EXPECT_EQ(big.number<std::uint8_t>(), 1);
  big.align(4);
  EXPECT_EQ(big.left(), 4U);
  EXPECT_EQ(big.number<std::uint16_t>(), 0x6162);
  EXPECT_FALSE(big.failed());
}

TEST(ByteCursor, BeyondTheEndIsNothing) {
  ByteCursor cursor(kBytes, std::endian::little);
  EXPECT_TRUE(cursor.bytes(9).empty());
  EXPECT_TRUE(cursor.failed());
  EXPECT_EQ(cursor.number<std::uint8_t>(), 0) << "nothing more once it has failed";
  EXPECT_EQ(ByteCursor({}, std::endian::big).number<double>(), 0);
}

}  // namespace
}  // namespace waymark
