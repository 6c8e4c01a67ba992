#include "tests/vm/uvc_camera/frame_feed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/capture/jpeg.h"

namespace waymark::uvc {
namespace {

/// `count` images of 400 x 20 px, each filled with its number.
FrameFeed numbered_images(int count, PixelFormat pixels) {
  FrameFeed feed;
  feed.format.width_px = 400;
  feed.format.height_px = 20;
  feed.format.pixels = pixels;
  for (int i = 0; i < count; ++i) feed.images.emplace_back(8000, static_cast<std::uint8_t>(40 * i));
  return feed;
}

/// The pixels that a host gets of a frame.
Bytes pixels_of(const Bytes& frame, PixelFormat pixels) {
  if (pixels == PixelFormat::grey) return frame;
  const auto loaded = decode_jpeg({reinterpret_cast<const char*>(frame.data()), frame.size()});
  return loaded ? loaded->image.pixels : Bytes{};
}

class FrameFeedPixels : public testing::TestWithParam<PixelFormat> {};

TEST_P(FrameFeedPixels, NoFrameIsSeenTwice) {
  const FrameFeed feed = numbered_images(3, GetParam());
  std::set<Bytes> seen;
  for (std::int64_t i = 1'000'000; i < 1'000'500; ++i) {
    seen.insert(pixels_of(feed.frame(i), GetParam()));
    seen.insert(pixels_of(feed.painted_frame(200, i), GetParam()));
  }
  EXPECT_EQ(seen.size(), 1000U);
}

TEST_P(FrameFeedPixels, NoiseChangesAPixelByFewGreyLevelsAndOnlyTheFirstRows) {
  const FrameFeed feed = numbered_images(3, GetParam());
  for (std::int64_t i = 999; i < 1012; ++i) {
    const Bytes pixels = pixels_of(feed.frame(i), GetParam());
    ASSERT_EQ(pixels.size(), 8000U);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const int difference = std::abs(pixels[k] - static_cast<int>(40 * (i % 3)));
      // A JPEG rounds.
      EXPECT_LE(difference, k < 400 * kNoiseRows ? 4 : 1) << "frame " << i << ", pixel " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, FrameFeedPixels,
                         testing::Values(PixelFormat::grey, PixelFormat::mjpeg));

}  // namespace
}  // namespace waymark::uvc
