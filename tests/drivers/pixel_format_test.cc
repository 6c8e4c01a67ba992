#include "drivers/pixel_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/capture/jpeg.h"

namespace waymark {
namespace {

struct Conversion {
  const char* format;
  std::array<std::uint8_t, 4> pair;  ///< two pixels of 16 bit, as they lie in memory
  std::array<std::uint8_t, 2> grey;
};

class Conversions : public testing::TestWithParam<Conversion> {};

TEST_P(Conversions, EachPixelIsItsLuma) {
  const PixelFormat& format = *find_pixel_format(GetParam().format);
  // 4 × 2 pixels, rows of 12 bytes: 8 of pixels, 4 of padding that must not show.
  constexpr std::size_t kStride = 12;
  std::vector<std::uint8_t> bytes(kStride + 8, 0xEE);
  for (const std::size_t at : {std::size_t{0}, std::size_t{4}, kStride, kStride + 4}) {
    std::copy(GetParam().pair.begin(), GetParam().pair.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  GrayImage image(4, 2);
  ASSERT_TRUE(convert_to_gray(format, bytes, kStride, image));
  const auto [a, b] = GetParam().grey;
  EXPECT_EQ(image.pixels, (std::vector<std::uint8_t>{a, b, a, b, a, b, a, b}));
}

INSTANTIATE_TEST_SUITE_P(PixelFormat, Conversions,
                         testing::Values(Conversion{"YUYV", {10, 128, 250, 127}, {10, 250}},
                                         Conversion{"UYVY", {128, 10, 127, 250}, {10, 250}},
                                         Conversion{"Y10", {0xFF, 0x03, 0x04, 0x02}, {255, 129}},
                                         Conversion{"Y12", {0xFF, 0x0F, 0x10, 0x08}, {255, 129}},
                                         Conversion{"Y16", {0xFF, 0xFF, 0xFF, 0x81}, {255, 129}},
                                         Conversion{"Y16", {0x00, 0x00, 0xFF, 0x00}, {0, 0}}),
                         [](const auto& info) {
                           return std::string(info.param.format) + "_" + std::to_string(info.index);
                         });

TEST(PixelFormat, NamesAndCodesLeadToOneAnother) {
  for (const PixelFormat& format : pixel_formats()) {
    EXPECT_EQ(find_pixel_format(format.name), &format);
    EXPECT_EQ(find_pixel_format(format.fourcc), &format);
  }
  EXPECT_EQ(find_pixel_format("MJPEG")->fourcc, V4L2_PIX_FMT_MJPEG);
  EXPECT_EQ(find_pixel_format("RGB3"), nullptr);
  EXPECT_EQ(find_pixel_format(std::uint32_t{V4L2_PIX_FMT_RGB24}), nullptr);
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_Y16), "Y16");
  EXPECT_EQ(fourcc_text(0x01020304), "????");
}

TEST(PixelFormat, JpegsOfTheRightSizeAreDecodedOthersRefused) {
  GrayImage ramp(16, 8);
  for (std::size_t i = 0; i < ramp.pixels.size(); ++i)
    ramp.pixels[i] = static_cast<std::uint8_t>(i);
  const std::string jpeg = *encode_jpeg(ramp.view(), 100);
  const std::vector<std::uint8_t> bytes(jpeg.begin(), jpeg.end());
  GrayImage image(16, 8);
  ASSERT_TRUE(convert_to_gray(*find_pixel_format("MJPG"), bytes, 0, image));
  for (std::size_t i = 0; i < ramp.pixels.size(); ++i) {
    EXPECT_NEAR(image.pixels[i], ramp.pixels[i], 3);
  }
  GrayImage other(16, 9);
  EXPECT_FALSE(convert_to_gray(*find_pixel_format("MJPG"), bytes, 0, other));
  for (const std::size_t length : {std::size_t{0}, std::size_t{10}, bytes.size() / 2}) {
    EXPECT_FALSE(convert_to_gray(*find_pixel_format("MJPG"), {bytes.data(), length}, 0, image));
  }
}

}  // namespace
}  // namespace waymark
