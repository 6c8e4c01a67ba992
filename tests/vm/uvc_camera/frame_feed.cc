#include "tests/vm/uvc_camera/frame_feed.h"

#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/capture/image_file.h"

namespace waymark::uvc {

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
    if (feed.frames.empty()) {
      feed.format.width_px = width;
      feed.format.height_px = height;
    } else if (width != feed.format.width_px || height != feed.format.height_px) {
      return fail(ErrorKind::bad_data, "{}: {}x{}, but the images before it are {}x{}",
                  file.string(), width, height, feed.format.width_px, feed.format.height_px);
    }
    if (pixels == PixelFormat::grey) {
      feed.frames.push_back(std::move(loaded->image.pixels));
      continue;
    }
    auto bytes = read_file(file);
    if (!bytes) return tl::make_unexpected(bytes.error());
    if (!bytes->starts_with("\xFF\xD8")) {
      return fail(ErrorKind::bad_data, "{}: not a JPEG file", file.string());
    }
    feed.frames.emplace_back(bytes->begin(), bytes->end());
  }
  if (feed.frames.empty()) return fail(ErrorKind::bad_data, "{}: no images", folder.string());
  for (const Bytes& frame : feed.frames) {
    feed.format.max_frame_bytes =
        std::max(feed.format.max_frame_bytes, static_cast<std::uint32_t>(frame.size()));
  }
  return feed;
}

}  // namespace waymark::uvc
