#include "core/capture/jpeg_segments.h"

#include <gtest/gtest.h>

#include "core/capture/jpeg.h"
#include "tests/support/exif_block.h"
#include "tests/support/test_pattern.h"

namespace waymark {
namespace {

std::string segment(char marker, const std::string& content) {
  const std::size_t length = content.size() + 2;
  return std::string{'\xFF', marker, static_cast<char>(length >> 8U), static_cast<char>(length)} +
         content;
}

std::string plain() { return *encode_jpeg(test_pattern(40, 24).view(), 90); }

/// Behind the start marker.
std::string with(const std::string& inserted) {
  const std::string jpeg = plain();
  return jpeg.substr(0, 2) + inserted + jpeg.substr(2);
}

TEST(JpegSegments, APlainImageHasOneScanAndIsUpright) {
  const JpegSegments found = walk_jpeg(plain(), 20);
  EXPECT_EQ(found.scans, 1);
  EXPECT_FALSE(found.progressive);
  EXPECT_EQ(found.orientation, 1);
  EXPECT_TRUE(found.tidied.empty());
}

TEST(JpegSegments, ScansAreCountedToTheLimit) {
  const std::string jpeg = plain();
  const auto scan = jpeg.find("\xFF\xDA");
  std::string many = jpeg.substr(0, scan);
  for (int i = 0; i < 400; ++i) many += jpeg.substr(scan, jpeg.size() - 2 - scan);
  EXPECT_EQ(walk_jpeg(many, 20).scans, 21);
  EXPECT_EQ(walk_jpeg(many, 1000).scans, 400);
}

TEST(JpegSegments, ProgressiveIsToldOfBothEntropyCodings) {
  for (const char frame : {'\xC2', '\xC6', '\xCA', '\xCE'}) {
    EXPECT_TRUE(walk_jpeg(with(segment(frame, "")), 20).progressive) << int{frame};
  }
  for (const char frame : {'\xC0', '\xC1', '\xC3', '\xC4', '\xC9', '\xCB', '\xCC', '\xDB'}) {
    EXPECT_FALSE(walk_jpeg(with(segment(frame, "")), 20).progressive) << int{frame};
  }
}

TEST(JpegSegments, AThumbnailsScanIsNone) {
  const std::string thumbnail = segment('\xE1', std::string("Exif\0\0", 6) + plain());
  EXPECT_EQ(walk_jpeg(with(thumbnail + thumbnail), 20).scans, 1);
}

TEST(JpegSegments, TheFirstExifBlockCounts) {
  const auto exif = [](int orientation) {
    const std::vector<std::uint8_t> block = exif_block(orientation, true);
    return segment('\xE1', std::string("Exif\0\0", 6) + std::string(block.begin(), block.end()));
  };
  EXPECT_EQ(walk_jpeg(with(exif(6) + exif(3)), 20).orientation, 6);
}

TEST(JpegSegments, StraysAndUnknownVersionsAreTidiedAway) {
  EXPECT_EQ(walk_jpeg(with("abc"), 20).tidied, plain());
  EXPECT_EQ(walk_jpeg(with(std::string("ab\xFF\0cd", 6)), 20).tidied, plain());
  EXPECT_TRUE(walk_jpeg(with("\xFF\xFF\xFF"), 20).tidied.empty()) << "markers may be filled up";
  const std::string adobe = segment('\xEE', std::string("Adobe\0\0\0\0\0\0\x07", 12));
  EXPECT_EQ(walk_jpeg(with(adobe), 20).tidied[2 + 4 + 11], 1);
  std::string jfif = plain();
  jfif[11] = 9;
  EXPECT_EQ(walk_jpeg(jfif, 20).tidied, plain());
}

TEST(JpegSegments, TakeTimeThatIsLinear) {
  // Two hundred thousand strays; a quadratic walk takes minutes.
  std::string strays;
  for (int i = 0; i < 200'000; ++i) strays += std::string("x\xFF\xFE\0\2", 5);
  EXPECT_EQ(walk_jpeg(with(strays), 20).tidied.size(), plain().size() + 800'000);
}

TEST(JpegSegments, EveryTruncationEndsQuietly) {
  const std::string whole = with(segment('\xE1', std::string("Exif\0\0", 6) + "II*"));
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    EXPECT_LE(walk_jpeg(std::string_view(whole).substr(0, size), 20).scans, 1);
  }
}

}  // namespace
}  // namespace waymark
