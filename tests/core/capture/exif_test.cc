#include "core/capture/exif.h"

#include <gtest/gtest.h>

#include "tests/support/exif_block.h"

namespace waymark {
namespace {

TEST(ExifOrientation, ReadInBothByteOrders) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    EXPECT_EQ(exif_orientation(exif_block(orientation, true)), orientation);
    EXPECT_EQ(exif_orientation(exif_block(orientation, false)), orientation);
  }
}

TEST(ExifOrientation, SaysAsStoredWhenItMakesNoSense) {
  EXPECT_EQ(exif_orientation(exif_block(0, true)), 1);
  EXPECT_EQ(exif_orientation(exif_block(9, true)), 1);
  EXPECT_EQ(exif_orientation({}), 1);
  std::vector<std::uint8_t> block = exif_block(6, true);
  block[0] = 'X';
  EXPECT_EQ(exif_orientation(block), 1);
}

TEST(ExifOrientation, EveryTruncationIsSurvived) {
  const std::vector<std::uint8_t> whole = exif_block(6, false);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    // A copy of exactly this size, so that the address sanitizer sees a read beyond it.
    const std::vector<std::uint8_t> part(whole.begin(),
                                         whole.begin() + static_cast<std::ptrdiff_t>(size));
    const int orientation = exif_orientation(part);
    EXPECT_TRUE(orientation == 1 || orientation == 6);
  }
}

TEST(ExifOrientation, WildOffsetsAreSurvived) {
  std::vector<std::uint8_t> block = exif_block(6, true);
  for (const std::uint8_t byte : {0x00, 0x7F, 0xFF}) {
    std::fill(block.begin() + 4, block.begin() + 8, byte);
    EXPECT_EQ(exif_orientation(block), 1);
  }
}

}  // namespace
}  // namespace waymark
