#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace waymark {

/// 8-bit grey pixels that somebody else owns (a GrayImage, a driver's buffer).
struct GrayView {
  const std::uint8_t* data = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::size_t stride_bytes = 0;

  [[nodiscard]] const std::uint8_t* row(int y) const {
    return data + static_cast<std::size_t>(y) * stride_bytes;
  }
};

/// 8-bit grey image that owns its pixels, rows without padding.
struct GrayImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> pixels;

  GrayImage() = default;
  GrayImage(int width, int height, std::uint8_t value = 0)
      : width_px(width),
        height_px(height),
        pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}

  [[nodiscard]] std::uint8_t* row(int y) {
    return pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px);
  }
  [[nodiscard]] const std::uint8_t* row(int y) const { return view().row(y); }
  [[nodiscard]] GrayView view() const {
    return {pixels.data(), width_px, height_px, static_cast<std::size_t>(width_px)};
  }
};

/// How 16-bit values were brought to 8.
struct DeepPixels {
  int largest = 0;      ///< of the image's values, 0…65535
  int bits_in_use = 0;  ///< 10, 12, 14 or 16: the fewest that hold it; the upper 8 of them are used
};

/// A decoded image and what the user should know of it.
struct LoadedImage {
  GrayImage image;
  bool orientation_ignored = false;  ///< EXIF asks for a rotation; pixels are as stored
  std::optional<DeepPixels> deep;    ///< of images with 16 bits per value
};

}  // namespace waymark
