#include "mapbuilder/import/ros_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "core/capture/png.h"
#include "tests/support/recordings.h"
#include "tests/support/test_pattern.h"

namespace waymark {
namespace {

using testing::HasSubstr;

/// An image whose samples are these bytes, rows as long as they must be.
RosImage image_of(const std::string& encoding, std::uint32_t width, std::uint32_t height,
                  const std::string& data) {
  RosImage image;
  image.width_px = width;
  image.height_px = height;
  image.encoding = encoding;
  image.step_bytes = static_cast<std::uint32_t>(data.size()) / height;
  image.data = {reinterpret_cast<const std::uint8_t*>(data.data()), data.size()};  // NOLINT: bytes
  return image;
}

std::string pixels_of(const std::string& pgm, std::size_t bytes) {
  return pgm.substr(pgm.size() - bytes);
}

TEST(RosImage, GreyIsKeptToTheBit) {
  const GrayImage pattern = test_pattern(37, 23);
  const std::string data(pattern.pixels.begin(), pattern.pixels.end());
  EXPECT_EQ(pgm_of_ros_image(image_of("mono8", 37, 23, data)).value(), encode_pgm(pattern.view()));
  EXPECT_EQ(pgm_of_ros_image(image_of("8UC1", 37, 23, data)).value(), encode_pgm(pattern.view()));
}

TEST(RosImage, RowsMayBePadded) {
  const auto pgm = pgm_of_ros_image(image_of("mono8", 2, 2, "ab..cd.."));
  EXPECT_EQ(pixels_of(*pgm, 4), "abcd");
  RosImage last = image_of("mono8", 2, 2, "ab..cd..");
  last.data = last.data.first(6);  // nothing need follow the last pixel
  EXPECT_EQ(pixels_of(pgm_of_ros_image(last).value(), 4), "abcd");
}

TEST(RosImage, SixteenBitsAreKept) {
  RosImage image = image_of("mono16", 2, 1, std::string("\x01\x02\x03\x04", 4));
  const auto little = pgm_of_ros_image(image);
  EXPECT_THAT(*little, HasSubstr("65535"));
  EXPECT_EQ(pixels_of(*little, 4), std::string("\x02\x01\x04\x03", 4))
      << "PGM's order is the other";
  image.big_endian = true;
  EXPECT_EQ(pixels_of(*pgm_of_ros_image(image), 4), std::string("\x01\x02\x03\x04", 4));
}

TEST(RosImage, ColourIsItsLuma) {
  const std::string rgb("\xC8\x64\x32", 3);  // 200, 100, 50: 59.8 + 58.7 + 5.7
  const std::string bgr("\x32\x64\xC8", 3);
  for (const auto& [encoding, data] : {std::pair<std::string, std::string>{"rgb8", rgb},
                                       {"bgr8", bgr},
                                       {"8UC3", bgr},
                                       {"rgba8", rgb + "\xFF"},
                                       {"bgra8", bgr + "\xFF"}}) {
    const auto pgm = pgm_of_ros_image(image_of(encoding, 1, 1, data));
    EXPECT_EQ(pixels_of(*pgm, 1), std::string(1, '\x7C')) << encoding;
  }
  const std::string wide("\x00\xC8\x00\x64\x00\x32", 6);
  EXPECT_EQ(pixels_of(*pgm_of_ros_image(image_of("rgb16", 1, 1, wide)), 2), "\x7C\x33")
      << "256 · 124.2, rounded";
}

TEST(RosImage, YuvIsItsY) {
  EXPECT_EQ(pixels_of(*pgm_of_ros_image(image_of("yuv422", 2, 1, "uAvB")), 2), "AB");
  EXPECT_EQ(pixels_of(*pgm_of_ros_image(image_of("yuv422_yuy2", 2, 1, "AuBv")), 2), "AB");
}

TEST(RosImage, BayerPatternsOfOneColourAreThatColour) {
  // Of a scene of one colour (200, 100, 50) each pattern sees its part, and all give one grey.
  const auto value_of = [](char colour) {
    return static_cast<char>(colour == 'r' ? 200 : colour == 'g' ? 100 : 50);
  };
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    std::string data;
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 7; ++x) {
        data += value_of(pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)]);
      }
    }
    const auto pgm = pgm_of_ros_image(image_of("bayer_" + pattern + "8", 7, 5, data));
    ASSERT_TRUE(pgm);
    EXPECT_EQ(pixels_of(*pgm, 35), std::string(35, '\x7C')) << pattern;
    std::string wide;
    for (const char value : data) wide += std::string(1, '\0') + value;
    const auto deep = pgm_of_ros_image(image_of("bayer_" + pattern + "16", 7, 5, wide));
    const std::string first = pixels_of(*deep, 70).substr(0, 2);
    EXPECT_EQ(first, "\x7C\x33") << pattern;
    EXPECT_EQ(pixels_of(*deep, 70).substr(68), first);
  }
}

TEST(RosImage, BayerPatternsAreInterpolated) {
  // A column of light in grey surroundings comes out where it is.
  std::string data;
  for (int y = 0; y < 4; ++y) data += std::string("\x10\x10\xF0\xF0\x10\x10", 6);
  const auto pgm = pgm_of_ros_image(image_of("bayer_rggb8", 6, 4, data));
  const std::string row = pixels_of(*pgm, 24).substr(6, 6);
  const auto grey = [&](std::size_t x) {
    return static_cast<int>(static_cast<unsigned char>(row[x]));
  };
  EXPECT_EQ(grey(0), 16);
  EXPECT_EQ(grey(5), 16);
  EXPECT_GT(grey(2), 100);
  EXPECT_GT(grey(3), 100);
  EXPECT_LT(grey(1), 130);
}

TEST(RosImage, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(pgm_of_ros_image(image_of("mono8", 4, 2, "abcdefg")).error().message,
              HasSubstr("7 bytes for 4×2 pixels"));
  EXPECT_FALSE(pgm_of_ros_image(image_of("mono8", 0, 1, "a")));
  EXPECT_FALSE(pgm_of_ros_image(image_of("bayer_rggb8", 1, 2, "ab")));
  EXPECT_THAT(pgm_of_ros_image(image_of("32FC1", 1, 1, "abcd")).error().message,
              HasSubstr("\"32FC1\" is not read"));
  EXPECT_FALSE(is_known_encoding(""));
  RosImage image = image_of("mono8", 1, 1, "a");
  image.height_px = 200'000'001;
  EXPECT_THAT(pgm_of_ros_image(image).error().message, HasSubstr("200 megapixels"));
  image.height_px = 200'000'000;
  EXPECT_THAT(pgm_of_ros_image(image).error().message, HasSubstr("1 bytes for"));
  image.step_bytes = 0;
  EXPECT_FALSE(pgm_of_ros_image(image));
}

TEST(CompressedKind, IsToldByTheBytes) {
  const GrayImage pattern = test_pattern(37, 23);
  RosCompressedImage image;
  image.format = "rgb8; jpeg compressed bgr8";
  const auto kind = [&](const std::string& file) {
    image.data = {reinterpret_cast<const std::uint8_t*>(file.data()), file.size()};  // NOLINT
    return kind_of_compressed(image);
  };
  const auto jpeg = kind(encode_jpeg(pattern.view(), 90).value());
  ASSERT_TRUE(jpeg);
  EXPECT_STREQ(jpeg->ending, "jpg");
  EXPECT_EQ(jpeg->size, (ImageSize{37, 23}));
  EXPECT_STREQ(kind(encode_png(pattern.view()).value())->ending, "png");
  EXPECT_THAT(kind("").error().message, HasSubstr("neither JPEG nor PNG"));
  EXPECT_FALSE(kind("\xFF\xD8\xFF"));
}

}  // namespace
}  // namespace waymark
