#include "tests/vm/uvc_camera/frame_feed.h"

#include <algorithm>

#include "core/capture/image_file.h"
#include "core/capture/jpeg.h"

namespace waymark::uvc {
namespace {

constexpr int kJpegQuality = 95;

void add_noise(Bytes& pixels, const CameraFormat& format, std::int64_t index) {
  const std::size_t width = format.width_px;
  for (std::size_t y = 0; y < std::min<std::size_t>(kNoiseRows, format.height_px); ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      if ((index >> std::min<std::size_t>(x / kNoiseRun_px, 63) & 1) != 0) {
        pixels[y * width + x] ^= kNoiseBit;
      }
    }
  }
}

/// Pixels as the camera sends them.
Bytes sent_as(const CameraFormat& format, Bytes pixels) {
  if (format.pixels == PixelFormat::grey) return pixels;
  const GrayView view{pixels.data(), format.width_px, format.height_px, format.width_px};
  const auto jpeg = encode_jpeg(view, kJpegQuality);
  return jpeg ? Bytes(jpeg->begin(), jpeg->end()) : Bytes{};
}

}  // namespace

Bytes FrameFeed::frame(std::int64_t index) const {
  Bytes pixels = images[static_cast<std::size_t>(index) % images.size()];
  add_noise(pixels, format, index);
  return sent_as(format, std::move(pixels));
}

Bytes FrameFeed::painted_frame(std::uint8_t grey, std::int64_t index) const {
  Bytes pixels(images.front().size(), grey);
  add_noise(pixels, format, index);
  return sent_as(format, std::move(pixels));
}

Expected<FrameFeed> read_frame_feed(const std::filesystem::path& folder, PixelFormat pixels) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (is_image_name(entry.path())) files.push_back(entry.path());
  }
  if (error) return fail(ErrorKind::no_input, "{}: {}", folder.string(), error.message());
  std::sort(files.begin(), files.end());

  FrameFeed feed;
  feed.format.pixels = pixels;
  for (const auto& file : files) {
    auto loaded = read_gray_image(file);
    if (!loaded) return tl::make_unexpected(loaded.error());
    const auto width = static_cast<std::uint16_t>(loaded->image.width_px);
    const auto height = static_cast<std::uint16_t>(loaded->image.height_px);
    if (feed.images.empty()) {
      feed.format.width_px = width;
      feed.format.height_px = height;
    } else if (width != feed.format.width_px || height != feed.format.height_px) {
      return fail(ErrorKind::bad_data, "{}: {}x{}, but the images before it are {}x{}",
                  file.string(), width, height, feed.format.width_px, feed.format.height_px);
    }
    feed.images.push_back(std::move(loaded->image.pixels));
  }
  if (feed.images.empty()) return fail(ErrorKind::bad_data, "{}: no images", folder.string());
  // No JPEG of these images is larger than their pixels.
  feed.format.max_frame_bytes = static_cast<std::uint32_t>(feed.images.front().size());
  return feed;
}

}  // namespace waymark::uvc
