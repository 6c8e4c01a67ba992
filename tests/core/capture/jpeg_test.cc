#include "core/capture/jpeg.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "core/capture/jpeg_segments.h"
#include "tests/support/exif_block.h"
#include "tests/support/test_pattern.h"

// After <cstdio>, which it needs.
#include <jpeglib.h>

namespace waymark {
namespace {

using testing::HasSubstr;

int largest_difference(const GrayImage& a, const GrayImage& b) {
  EXPECT_EQ(a.width_px, b.width_px);
  EXPECT_EQ(a.height_px, b.height_px);
  int largest = 0;
  for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) {
    largest = std::max(largest, std::abs(a.pixels[i] - b.pixels[i]));
  }
  return largest;
}

/// Puts an APP1 segment with an EXIF block behind the start marker.
std::string with_exif(const std::string& jpeg, const std::vector<std::uint8_t>& block) {
  const std::size_t length = 2 + 6 + block.size();
  std::string segment = "\xFF\xE1";
  segment += static_cast<char>(length >> 8U);
  segment += static_cast<char>(length & 0xFFU);
  segment += std::string("Exif\0\0", 6);
  segment.append(block.begin(), block.end());
  return jpeg.substr(0, 2) + segment + jpeg.substr(2);
}

/// Decoded by libjpeg with its defaults.
std::vector<std::uint8_t> libjpeg_gray(const std::string& jpeg) {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size());
  jpeg_read_header(&info, TRUE);
  info.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&info);
  std::vector<std::uint8_t> pixels(std::size_t{info.output_width} * info.output_height);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = &pixels[std::size_t{info.output_scanline} * info.output_width];
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  return pixels;
}

TEST(Jpeg, WrittenImageReadsBackNearly) {
  const GrayImage image = test_pattern(100, 75);
  const auto bytes = encode_jpeg(image.view(), 95);
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_TRUE(looks_like_jpeg(*bytes));
  const auto loaded = decode_jpeg(*bytes);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_LE(largest_difference(loaded->image, image), 4);
  EXPECT_FALSE(loaded->orientation_ignored);
  EXPECT_FALSE(loaded->deep);
  EXPECT_LT(encode_jpeg(image.view(), 10)->size(), bytes->size());
}

TEST(Jpeg, ColourIsReadByItsLuma) {
  cv::Mat picture(64, 96, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      picture.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(3 * y), 200);
    }
  }
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 100}));
  const auto loaded = decode_jpeg({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  ASSERT_TRUE(loaded) << loaded.error().message;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto& bgr = picture.at<cv::Vec3b>(y, x);
      EXPECT_NEAR(loaded->image.pixels[static_cast<std::size_t>(y * picture.cols + x)],
                  0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2], 3);
    }
  }
}

TEST(Jpeg, ExifOrientationIsIgnoredAndSaid) {
  const GrayImage image = test_pattern(40, 24);
  const std::string plain = *encode_jpeg(image.view(), 95);
  for (const bool little_endian : {true, false}) {
    const auto rotated = decode_jpeg(with_exif(plain, exif_block(6, little_endian)));
    ASSERT_TRUE(rotated) << rotated.error().message;
    EXPECT_TRUE(rotated->orientation_ignored);
    EXPECT_EQ(rotated->image.pixels, decode_jpeg(plain)->image.pixels) << "pixels are as stored";
    const auto upright = decode_jpeg(with_exif(plain, exif_block(1, little_endian)));
    ASSERT_TRUE(upright);
    EXPECT_FALSE(upright->orientation_ignored);
  }
}

TEST(Jpeg, EveryTruncationIsRefused) {
  const std::string whole = *encode_jpeg(test_pattern(64, 48).view(), 80);
  for (std::size_t size = 0; size < whole.size(); size += 1 + size / 50) {
    const auto loaded = decode_jpeg(std::string_view(whole).substr(0, size));
    ASSERT_FALSE(loaded) << size << " of " << whole.size() << " bytes";
    EXPECT_EQ(loaded.error().kind, ErrorKind::bad_data);
    EXPECT_THAT(loaded.error().message, HasSubstr("damaged or truncated JPEG: "));
  }
}

TEST(Jpeg, FlippedBitsNeverCrash) {
  const std::string whole = *encode_jpeg(test_pattern(64, 48).view(), 80);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
    (void)decode_jpeg(damaged);  // some flips only change grey values
  }
}

TEST(Jpeg, BytesBetweenTheSegmentsAreAllowed) {
  const GrayImage image = test_pattern(40, 24);
  const std::string plain = *encode_jpeg(image.view(), 95);
  const auto table = plain.find("\xFF\xDB");  // the quantization table's segment
  ASSERT_NE(table, std::string::npos);
  const auto loaded = decode_jpeg(plain.substr(0, table) + "abc" + plain.substr(table));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->image.pixels, decode_jpeg(plain)->image.pixels);
}

TEST(Jpeg, DecodesIntoMemoryThatIsThereAndRefusesAnotherSize) {
  const GrayImage pattern = test_pattern(40, 24);
  const std::string bytes = *encode_jpeg(pattern.view(), 95);
  GrayImage image(40, 24);
  const auto* const memory = image.pixels.data();
  ASSERT_TRUE(decode_jpeg_into(bytes, image));
  EXPECT_EQ(image.pixels, decode_jpeg(bytes)->image.pixels);
  EXPECT_EQ(image.pixels.data(), memory);
  GrayImage other(24, 40);
  const Status refused = decode_jpeg_into(bytes, other);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("the image is 40×24, rig.yaml says 24×40"));
}

TEST(Jpeg, AFrameOfSeveralScansIsRefusedBeforeItTakesTime) {
  std::string bytes = *encode_jpeg(test_pattern(40, 24).view(), 95);
  const auto frame = bytes.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  bytes[frame + 1] = '\xC2';  // says that it is progressive
  GrayImage image(40, 24);
  const Status refused = decode_jpeg_into(bytes, image);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("several scans"));
}

TEST(Jpeg, HugeSizesAreRefusedBeforeMemoryIsAskedFor) {
  std::string bytes = *encode_jpeg(test_pattern(40, 24).view(), 95);
  const auto frame =
      bytes.find("\xFF\xC0");  // marker, length (2), precision, height (2), width (2)
  ASSERT_NE(frame, std::string::npos);
  bytes.replace(frame + 5, 4, "\xFF\x00\xFF\x00", 4);
  const auto loaded = decode_jpeg(bytes);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("65280×65280 px; more than 200 megapixels"));
}

TEST(Jpeg, AnotherSizeThanExpectedIsRefusedBeforePixelsAreDecoded) {
  std::string bytes = *encode_jpeg(test_pattern(40, 24).view(), 95);
  const auto frame = bytes.find("\xFF\xC0");
  bytes.replace(frame + 5, 4, "\xFF\x00\xFF\x00", 4);  // 4.3 gigapixels
  const auto loaded = decode_jpeg(bytes, ImageSize{40, 24});
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("the image is 65280×65280, rig.yaml says 40×24"));
}

std::string progressive_jpeg(int scans) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(".jpg", cv::Mat(24, 40, CV_8UC1, cv::Scalar(90)), bytes,
                           {cv::IMWRITE_JPEG_PROGRESSIVE, 1}));
  std::string jpeg(bytes.begin(), bytes.end());
  const auto last = jpeg.rfind("\xFF\xDA");
  const std::string scan = jpeg.substr(last, jpeg.size() - 2 - last);
  for (int i = 0; i < scans; ++i) jpeg.insert(last, scan);
  return jpeg;
}

TEST(Jpeg, ProgressiveFilesAreRead) {
  const auto loaded = decode_jpeg(progressive_jpeg(0));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_NEAR(loaded->image.pixels[100], 90, 2);
}

TEST(Jpeg, MoreScansThanProgramsWriteAreRefused) {
  const int own = walk_jpeg(progressive_jpeg(0), 20).scans;
  // One that repeats a scan is damaged, but that is found when it is decoded.
  EXPECT_THAT(decode_jpeg(progressive_jpeg(20 - own)).error().message, HasSubstr("damaged"));
  for (const int scans : {21 - own, 400, 20'000}) {
    const auto loaded = decode_jpeg(progressive_jpeg(scans));
    ASSERT_FALSE(loaded) << scans;
    EXPECT_THAT(loaded.error().message, HasSubstr("more than 20 scans"));
  }
}

/// Grey, the constant part in its first scan and three frequencies in each of the others but the
/// last, which has the rest.
std::string jpeg_of_scans(const GrayImage& image, int scans) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;  // NOLINT: libjpeg's type
  jpeg_mem_dest(&info, &buffer, &size);
  info.image_width = static_cast<JDIMENSION>(image.width_px);
  info.image_height = static_cast<JDIMENSION>(image.height_px);
  info.input_components = 1;
  info.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&info);
  std::vector<jpeg_scan_info> script(static_cast<std::size_t>(scans));
  for (int i = 0; i < scans; ++i) {
    jpeg_scan_info& scan = script[static_cast<std::size_t>(i)];
    scan.comps_in_scan = 1;
    scan.Ss = i == 0 ? 0 : 3 * i - 2;
    scan.Se = i == 0 ? 0 : i == scans - 1 ? 63 : 3 * i;
  }
  info.scan_info = script.data();
  info.num_scans = scans;
  jpeg_start_compress(&info, TRUE);
  for (int y = 0; y < image.height_px; ++y) {
    std::vector<std::uint8_t> samples(image.row(y), image.row(y) + image.width_px);
    JSAMPROW row = samples.data();
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  std::string bytes(reinterpret_cast<const char*>(buffer), size);
  jpeg_destroy_compress(&info);
  std::free(buffer);
  return bytes;
}

TEST(Jpeg, OfTwentyScansItIsReadOfTwentyOneItIsNot) {
  const GrayImage image = test_pattern(40, 24);
  const auto loaded = decode_jpeg(jpeg_of_scans(image, 20));
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto usual = decode_jpeg(jpeg_of_scans(image, 2));
  EXPECT_EQ(loaded->image.pixels, usual->image.pixels);
  const auto refused = decode_jpeg(jpeg_of_scans(image, 21));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("more than 20 scans"));
}

TEST(Jpeg, BytesBehindTheLastPixelAreAllowed) {
  const std::string plain = *encode_jpeg(test_pattern(40, 24).view(), 95);
  for (const std::string& padding : {std::string(1, '\0'), std::string(37, '\x11')}) {
    const auto loaded = decode_jpeg(plain.substr(0, plain.size() - 2) + padding + "\xFF\xD9");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->image.pixels, decode_jpeg(plain)->image.pixels);
  }
}

TEST(Jpeg, HarmlessBytesDoNotHideHarm) {
  const std::string plain = *encode_jpeg(test_pattern(64, 48).view(), 90);
  const auto table = plain.find("\xFF\xDB");
  const std::string padded = plain.substr(0, table) + "abc" + plain.substr(table);
  std::string other_version = plain;
  other_version[11] = 9;
  for (const std::string& odd : {padded, other_version}) {
    ASSERT_TRUE(decode_jpeg(odd));
    EXPECT_FALSE(decode_jpeg(odd.substr(0, odd.size() * 3 / 4))) << "cut off";
  }
}

/// As the library has always decoded: detections depend on every grey value.
TEST(Jpeg, GreyValuesAreThoseOfLibjpegsExactTransform) {
  for (const int quality : {30, 75, 98}) {
    std::vector<std::uint8_t> bytes;
    cv::Mat picture(48, 64, CV_8UC3);
    const GrayImage pattern = test_pattern(64, 48);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        const std::uint8_t value = pattern.row(y)[x];
        picture.at<cv::Vec3b>(y, x) =
            cv::Vec3b(value, static_cast<std::uint8_t>(255 - value), static_cast<std::uint8_t>(x));
      }
    }
    ASSERT_TRUE(cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality}));
    const std::string jpeg(bytes.begin(), bytes.end());
    EXPECT_EQ(decode_jpeg(jpeg)->image.pixels, libjpeg_gray(jpeg));
  }
}

std::string cmyk_jpeg() {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;  // NOLINT: libjpeg's type
  jpeg_mem_dest(&info, &buffer, &size);
  info.image_width = 8;
  info.image_height = 1;
  info.input_components = 4;
  info.in_color_space = JCS_CMYK;
  jpeg_set_defaults(&info);
  jpeg_start_compress(&info, TRUE);
  std::vector<std::uint8_t> samples(32, 100);
  JSAMPROW row = samples.data();
  jpeg_write_scanlines(&info, &row, 1);
  jpeg_finish_compress(&info);
  std::string bytes(reinterpret_cast<const char*>(buffer), size);
  jpeg_destroy_compress(&info);
  std::free(buffer);
  return bytes;
}

TEST(Jpeg, CmykIsRefused) {
  const auto loaded = decode_jpeg(cmyk_jpeg());
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("CMYK"));
}

TEST(Jpeg, SidesBeyondTheFormatCantBeWritten) {
  const std::vector<std::uint8_t> pixels(65501, 0);
  EXPECT_TRUE(encode_jpeg({pixels.data(), 65500, 1, 65500}, 90));
  const auto bytes = encode_jpeg({pixels.data(), 65501, 1, 65501}, 90);
  ASSERT_FALSE(bytes);
  EXPECT_THAT(bytes.error().message, HasSubstr("65501×1"));
}

}  // namespace
}  // namespace waymark
