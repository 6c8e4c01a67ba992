#include "core/capture/png.h"

#include <gmock/gmock.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/exif_block.h"
#include "tests/support/libpng_image.h"
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

/// Read by libpng: the upper 8 of 16 bits, without alpha, colours by the same weights.
std::vector<std::uint8_t> libpng_gray(std::string bytes) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_read_fn(png, &bytes, [](png_structp to, png_bytep data, std::size_t size) {
    auto& rest = *static_cast<std::string*>(png_get_io_ptr(to));
    std::copy_n(rest.begin(), size, data);
    rest.erase(0, size);
  });
  png_read_png(png, info, PNG_TRANSFORM_STRIP_16 | PNG_TRANSFORM_EXPAND | PNG_TRANSFORM_STRIP_ALPHA,
               nullptr);
  const std::size_t channels = png_get_channels(png, info);
  png_bytepp rows = png_get_rows(png, info);
  std::vector<std::uint8_t> gray;
  for (int y = 0; y < kPngHeight; ++y) {
    for (std::size_t x = 0; x < kPngWidth; ++x) {
      const png_byte* pixel = rows[y] + x * channels;
      gray.push_back(channels == 1
                         ? pixel[0]
                         : static_cast<std::uint8_t>(
                               (299 * pixel[0] + 587 * pixel[1] + 114 * pixel[2] + 500) / 1000));
    }
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return gray;
}

TEST(Png, WrittenImageReadsBackToTheSame) {
  const GrayImage image = test_pattern(101, 75);
  const auto bytes = encode_png(image.view());
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_TRUE(looks_like_png(*bytes));
  const auto loaded = decode_png(*bytes);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->image.width_px, 101);
  EXPECT_EQ(loaded->image.pixels, image.pixels);
  EXPECT_FALSE(loaded->deep);
  EXPECT_FALSE(loaded->orientation_ignored);
}

TEST(Png, SixteenBitsAreReducedToTheUpperEightAndSaid) {
  cv::Mat picture(10, 12, CV_16UC1, cv::Scalar(0xAB7F));
  const auto loaded = decode_png(png_of(picture));
  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_TRUE(loaded->deep);
  EXPECT_EQ(loaded->deep->bits_in_use, 16);
  EXPECT_EQ(loaded->deep->largest, 0xAB7F);
  EXPECT_THAT(loaded->image.pixels, Each(0xAB));
}

TEST(Png, BitsInTheLowEndAreReadAsSuch) {
  for (const int bits : {10, 12, 14}) {
    cv::Mat picture(10, 12, CV_16UC1, cv::Scalar(0));
    picture.at<std::uint16_t>(3, 4) = static_cast<std::uint16_t>((1 << bits) - 4);
    picture.at<std::uint16_t>(9, 11) = static_cast<std::uint16_t>(1 << (bits - 1));
    const auto loaded = decode_png(png_of(picture));
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->deep->bits_in_use, bits);
    EXPECT_EQ(loaded->deep->largest, (1 << bits) - 4);
    EXPECT_EQ(loaded->image.row(3)[4], ((1 << bits) - 4) >> (bits - 8));
    EXPECT_EQ(loaded->image.row(9)[11], 128);
    EXPECT_EQ(loaded->image.row(0)[0], 0);
  }
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

/// Every kind of pixel in every order of rows, written and read by libpng's own functions.
TEST(Png, EveryKindIsReadAsLibpngDoes) {
  const int kinds[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                       PNG_COLOR_TYPE_RGB_ALPHA, PNG_COLOR_TYPE_PALETTE};
  for (const int kind : kinds) {
    for (const int depth : {1, 2, 4, 8, 16}) {
      if (depth < 8 && kind != PNG_COLOR_TYPE_GRAY && kind != PNG_COLOR_TYPE_PALETTE) continue;
      if (depth == 16 && kind == PNG_COLOR_TYPE_PALETTE) continue;
      for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
        const std::string bytes = libpng_png(kind, depth, interlace);
        const auto loaded = decode_png(bytes);
        ASSERT_TRUE(loaded) << kind << ' ' << depth << ' ' << loaded.error().message;
        const std::vector<std::uint8_t> expected = libpng_gray(bytes);
        EXPECT_EQ(loaded->image.pixels, expected) << kind << ' ' << depth << ' ' << interlace;
      }
    }
  }
}

TEST(Png, AnotherSizeThanExpectedIsRefusedBeforePixelsAreDecoded) {
  const std::string bytes = *encode_png(test_pattern(64, 48).view());
  EXPECT_TRUE(decode_png(bytes, ImageSize{64, 48}));
  const auto loaded = decode_png(bytes.substr(0, 40), ImageSize{48, 64});
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("the image is 64×48, rig.yaml says 48×64"));
}

TEST(Png, TextsThatUnpackToMoreThanAnImageHoldsAreRefused) {
  const auto with_texts = [](std::size_t length, int count) {
    const std::vector<Bytef> zeros(length, 0);
    uLongf size = compressBound(zeros.size());
    std::vector<Bytef> packed(size);
    EXPECT_EQ(compress(packed.data(), &size, zeros.data(), zeros.size()), Z_OK);
    const std::string text =
        chunk("zTXt", std::string("a\0\0", 3) + std::string(packed.begin(), packed.begin() + size));
    std::string bytes = *encode_png(test_pattern(8, 8).view());
    for (int i = 0; i < count; ++i) bytes.insert(kAfterHeader, text);
    return bytes;
  };
  EXPECT_TRUE(decode_png(with_texts(3'900'000, 4)));
  EXPECT_FALSE(decode_png(with_texts(4'300'000, 1)));
  EXPECT_FALSE(decode_png(with_texts(3'900'000, 5)));
  EXPECT_FALSE(decode_png(with_texts(64 << 20, 1)));
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
