#pragma once

#include "core/capture/gray_image.h"

namespace waymark {

/// A smooth pattern that differs under every rotation and mirroring, with all grey levels.
inline GrayImage test_pattern(int width_px, int height_px) {
  GrayImage image(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      image.row(y)[x] =
          static_cast<std::uint8_t>((200 * x / width_px) + (55 * y * y / (height_px * height_px)));
    }
  }
  return image;
}

}  // namespace waymark
