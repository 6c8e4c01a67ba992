#include "core/capture/png.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/exif_block.h"
#include "tests/support/test_pattern.h"

namespace waymark {
namespace {

using testing::Each;
using testing::HasSubstr;

std::string png_of(const cv::Mat& picture, const std::vector<int>& options = {}) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(".png", picture, bytes, options));
  return {bytes.begin(), bytes.end()};
}

std::string big_endian(std::size_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto crc =
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(data.size()) + body + big_endian(crc);
}

constexpr std::size_t kAfterHeader = 8 + 25;  ///< signature and IHDR chunk

TEST(Png, WrittenImageReadsBackToTheSame) {
  const GrayImage image = test_pattern(101, 75);
  const auto bytes = encode_png(image.view());
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_TRUE(looks_like_png(*bytes));
  const auto loaded = decode_png(*bytes);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->image.width_px, 101);
  EXPECT_EQ(loaded->image.pixels, image.pixels);
  EXPECT_FALSE(loaded->reduced_from_16_bit);
  EXPECT_FALSE(loaded->orientation_ignored);
}

TEST(Png, SixteenBitsAreReducedToTheUpperEightAndSaid) {
  cv::Mat picture(10, 12, CV_16UC1, cv::Scalar(0xAB7F));
  const auto loaded = decode_png(png_of(picture));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->reduced_from_16_bit);
  EXPECT_THAT(loaded->image.pixels, Each(0xAB));
}

TEST(Png, ColourIsReadByItsLumaWithoutAlpha) {
  const auto colour = decode_png(png_of(cv::Mat(4, 5, CV_8UC3, cv::Scalar(10, 100, 200))));
  ASSERT_TRUE(colour) << colour.error().message;
  EXPECT_THAT(colour->image.pixels, Each(120));  // 0.114·10 + 0.587·100 + 0.299·200 = 119.6
  const auto alpha = decode_png(png_of(cv::Mat(4, 5, CV_8UC4, cv::Scalar(10, 100, 200, 0))));
  ASSERT_TRUE(alpha) << alpha.error().message;
  EXPECT_THAT(alpha->image.pixels, Each(120));
  const auto deep = decode_png(png_of(cv::Mat(4, 5, CV_16UC3, cv::Scalar(2560, 25600, 51200))));
  ASSERT_TRUE(deep) << deep.error().message;
  EXPECT_THAT(deep->image.pixels, Each(120));
}

TEST(Png, GammaChunkLeavesTheStoredValues) {
  std::string bytes = png_of(cv::Mat(4, 5, CV_8UC3, cv::Scalar(10, 100, 200)));
  bytes.insert(kAfterHeader, chunk("gAMA", big_endian(100000)));
  const auto loaded = decode_png(bytes);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->image.pixels, Each(120));
}

TEST(Png, BilevelIsBlackAndWhite) {
  cv::Mat picture(9, 17, CV_8UC1, cv::Scalar(0));
  picture.at<std::uint8_t>(4, 16) = 255;
  const auto loaded = decode_png(png_of(picture, {cv::IMWRITE_PNG_BILEVEL, 1}));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->image.row(4)[16], 255);
  EXPECT_EQ(loaded->image.row(4)[15], 0);
}

TEST(Png, ExifOrientationIsIgnoredAndSaid) {
  const GrayImage image = test_pattern(16, 9);
  for (const int orientation : {1, 6}) {
    const std::vector<std::uint8_t> block = exif_block(orientation, true);
    std::string bytes = *encode_png(image.view());
    bytes.insert(kAfterHeader, chunk("eXIf", {block.begin(), block.end()}));
    const auto loaded = decode_png(bytes);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->orientation_ignored, orientation != 1);
    EXPECT_EQ(loaded->image.pixels, image.pixels);
  }
}

TEST(Png, EveryTruncationIsRefused) {
  const std::string whole = *encode_png(test_pattern(64, 48).view());
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 50) {
    const auto loaded = decode_png(std::string_view(whole).substr(0, size));
    ASSERT_FALSE(loaded) << size << " of " << whole.size() << " bytes";
    EXPECT_EQ(loaded.error().kind, ErrorKind::bad_data);
    EXPECT_THAT(loaded.error().message, HasSubstr("damaged or truncated PNG: "));
  }
}

TEST(Png, FlippedBitsNeverCrash) {
  const std::string whole = *encode_png(test_pattern(64, 48).view());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
    (void)decode_png(damaged);  // flips in chunks that don't matter are passed over
  }
}

TEST(Png, DamagedPixelsAreRefused) {
  std::string bytes = *encode_png(test_pattern(64, 48).view());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  EXPECT_FALSE(decode_png(bytes));
}

TEST(Png, HugeSizesAreRefusedBeforeMemoryIsAskedFor) {
  std::string bytes = *encode_png(test_pattern(8, 8).view());
  const std::string header = big_endian(500'000) + big_endian(401) + std::string("\x08\0\0\0\0", 5);
  bytes.replace(8, 25, chunk("IHDR", header));
  const auto loaded = decode_png(bytes);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("500000×401 px; more than 200 megapixels"));
}

TEST(Png, EmptyImageCantBeWritten) { EXPECT_FALSE(encode_png(GrayView{})); }

}  // namespace
}  // namespace waymark
