#pragma once

#include <algorithm>

#include "core/capture/gray_image.h"

namespace waymark {

/// A part of an image: pixels from (left, top) on.
struct ImageWindow {
  int left_px = 0;
  int top_px = 0;
  int width_px = 0;
  int height_px = 0;

  [[nodiscard]] long area_px2() const { return long{width_px} * height_px; }
};

/// What of the window lies in the image, begun at multiples of `grid_px`; of no size where nothing
/// does.
[[nodiscard]] inline ImageWindow within(const GrayView& image, const ImageWindow& window,
                                        int grid_px = 1) {
  const auto begin = [&](int at) { return std::max(0, at) / grid_px * grid_px; };
  const auto end = [](int at, int length, int limit) {
    return static_cast<int>(std::min<long>(limit, long{at} + length));
  };
  ImageWindow part;
  part.left_px = begin(window.left_px);
  part.top_px = begin(window.top_px);
  part.width_px = std::max(0, end(window.left_px, window.width_px, image.width_px) - part.left_px);
  part.height_px = std::max(0, end(window.top_px, window.height_px, image.height_px) - part.top_px);
  return part;
}

/// The window's pixels; it lies in the image.
[[nodiscard]] inline GrayView view_of(const GrayView& image, const ImageWindow& window) {
  return {image.row(window.top_px) + window.left_px, window.width_px, window.height_px,
          image.stride_bytes};
}

}  // namespace waymark
