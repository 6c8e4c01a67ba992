#include "core/capture/image_file.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_pattern.h"

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(ImageFile, KnowsImagesByTheirNames) {
  for (const char* name : {"1.jpg", "1.JPEG", "a/b.png", "1.Pgm"}) {
    EXPECT_TRUE(is_image_name(name)) << name;
  }
  for (const char* name : {"1", "jpg", ".jpg", "1.bmp", "1.jpg.txt", "1.pngx"}) {
    EXPECT_FALSE(is_image_name(name)) << name;
  }
}

TEST(ImageFile, WritesAndReadsEveryFormat) {
  const TemporaryFolder folder;
  const GrayImage image = test_pattern(64, 48);
  for (const char* name : {"1.jpg", "1.jpeg", "1.png", "1.PGM"}) {
    const auto file = folder.path() / name;
    ASSERT_TRUE(write_gray_image(file, image.view()));
    const auto loaded = read_gray_image(file);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->image.width_px, 64);
    EXPECT_EQ(loaded->image.height_px, 48);
    EXPECT_NEAR(loaded->image.row(40)[60], image.view().row(40)[60], 3) << name;
  }
  EXPECT_EQ(read_gray_image(folder.path() / "1.png")->image.pixels, image.pixels);
}

TEST(ImageFile, ContentCountsNotTheName) {
  const TemporaryFolder folder;
  const GrayImage image = test_pattern(64, 48);
  ASSERT_TRUE(write_gray_image(folder.path() / "1.png", image.view()));
  const auto renamed = folder.write("1.jpg", folder.read("1.png"));
  EXPECT_EQ(read_gray_image(renamed)->image.pixels, image.pixels);
}

TEST(ImageFile, AbsentFileIsNoInput) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_gray_image(folder.path() / "absent.jpg").error().kind, ErrorKind::no_input);
  EXPECT_EQ(read_gray_image(folder.path()).error().kind, ErrorKind::no_input);
}

TEST(ImageFile, WhatIsNoImageIsBadDataInOneLine) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_gray_image(folder.path() / "1.png", test_pattern(64, 48).view()));
  const std::string whole = folder.read("1.png");
  const auto expect_bad = [&](std::string_view content, const char* message) {
    const auto loaded = read_gray_image(folder.write("bad.jpg", content));
    ASSERT_FALSE(loaded) << message;
    EXPECT_EQ(loaded.error().kind, ErrorKind::bad_data);
    EXPECT_THAT(loaded.error().message, HasSubstr("bad.jpg: "));
    EXPECT_THAT(loaded.error().message, HasSubstr(message));
    EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
  };
  expect_bad("", "empty file");
  expect_bad("hello\n", "no image: neither JPEG nor PNG nor PGM");
  expect_bad("GIF89a", "a GIF image, which is not read; convert it to PNG");
  expect_bad(whole.substr(0, whole.size() / 2), "truncated PNG");
  expect_bad("\xFF\xD8\xFF\xE0", "truncated JPEG");
  expect_bad("P5 100 100 255\nabc", "truncated PGM");
}

TEST(ImageFile, AnotherSizeThanTheRigsIsRefusedByTheHeader) {
  const TemporaryFolder folder;
  for (const char* name : {"1.jpg", "1.png", "1.pgm"}) {
    const auto file = folder.path() / name;
    ASSERT_TRUE(write_gray_image(file, test_pattern(64, 48).view()));
    EXPECT_TRUE(read_gray_image(file, ImageSize{64, 48})) << name;
    const auto refused = read_gray_image(file, ImageSize{48, 64});
    ASSERT_FALSE(refused) << name;
    EXPECT_THAT(refused.error().message, HasSubstr("the image is 64×48, rig.yaml says 48×64"));
    const auto size = read_image_size(file);
    ASSERT_TRUE(size) << name;
    EXPECT_EQ(*size, (ImageSize{64, 48}));
  }
}

TEST(ImageFile, WhatNoImageOfTheRigsSizeNeedsIsNotRead) {
  const TemporaryFolder folder;
  // 8 bytes per pixel and 1 MiB; one byte more is refused without being read.
  std::string pgm = "P5 64 48 255\n" + std::string(64 * 48, 'x');
  pgm.resize((std::size_t{1} << 20) + 8 * 64 * 48, '\0');
  EXPECT_TRUE(read_gray_image(folder.write("1.pgm", pgm), ImageSize{64, 48}));
  const auto refused = read_gray_image(folder.write("1.pgm", pgm + "x"), ImageSize{64, 48});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("larger than"));
  const auto sparse = folder.write("2.jpg", "");
  std::filesystem::resize_file(sparse, std::size_t{1} << 31);
  EXPECT_EQ(read_gray_image(sparse).error().kind, ErrorKind::bad_data);
}

/// In colour, complete only after its last scan.
std::string progressive_jpeg(int width_px, int height_px) {
  std::vector<std::uint8_t> bytes;
  const cv::Mat picture(height_px, width_px, CV_8UC3, cv::Scalar(90, 120, 40));
  EXPECT_TRUE(cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}));
  return {bytes.begin(), bytes.end()};
}

TEST(ImageFile, AnImageTakesTheMemoryOfItsPixelsBesideItsFile) {
  const TemporaryFolder folder;
  const ImageSize size{4000, 3000};
  const std::size_t pixels = std::size_t{4000} * 3000;
  const GrayImage image = test_pattern(4000, 3000);
  for (const char* name : {"1.jpg", "1.png", "1.pgm"}) {
    ASSERT_TRUE(write_gray_image(folder.path() / name, image.view()));
  }
  folder.write("2.jpg", progressive_jpeg(4000, 3000));
  constexpr std::size_t kFew = 4'000'000;  // tables and buffers of libraries
  for (const auto& [name, bytes_per_pixel] :
       {std::pair("1.jpg", 1U), {"1.png", 1U}, {"1.pgm", 1U}, {"2.jpg", 7U}}) {
    const auto file = folder.path() / name;
    bool taken = false;
    const std::size_t peak =
        test::peak_memory([&] { taken = read_gray_image(file, size).has_value(); });
    EXPECT_TRUE(taken) << name;
    EXPECT_LT(peak, bytes_per_pixel * pixels + std::filesystem::file_size(file) + kFew) << name;
  }
}

TEST(ImageFile, FormatsThatAreNotReadAreNamed) {
  const TemporaryFolder folder;
  const std::pair<std::string, const char*> inputs[] = {
      {"BM1234", "BMP"},
      {std::string("II*\0abcd", 8), "TIFF"},
      {std::string("MM\0*abcd", 8), "TIFF"},
      {"RIFF1234WEBPVP8 ", "WebP"},
      {"GIF89a", "GIF"},
      {"1234ftypheic", "HEIF"},
  };
  for (const auto& [content, name] : inputs) {
    const auto loaded = read_gray_image(folder.write("1.png", content));
    ASSERT_FALSE(loaded) << name;
    EXPECT_EQ(loaded.error().cause, Cause::format);
    EXPECT_THAT(loaded.error().message, HasSubstr(fmt::format("a {} image", name)));
  }
}

TEST(ImageFile, UnknownEndingCantBeWritten) {
  const TemporaryFolder folder;
  const GrayImage image = test_pattern(8, 8);
  const auto status = write_gray_image(folder.path() / "1.bmp", image.view());
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::usage);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "1.bmp"));
  EXPECT_EQ(write_gray_image(folder.path() / "absent/1.png", image.view()).error().kind,
            ErrorKind::cant_create);
}

TEST(ImageFile, WhatCantBeEncodedLeavesTheEarlierFile) {
  const TemporaryFolder folder;
  const auto file = folder.write("1.png", "earlier");
  EXPECT_FALSE(write_gray_image(file, GrayView{}));
  EXPECT_EQ(folder.read("1.png"), "earlier");
}

}  // namespace
}  // namespace waymark
