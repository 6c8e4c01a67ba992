#pragma once

#include <cstdint>
#include <vector>

#include "core/capture/gray_image.h"
#include "core/detect/tile_thresholds.h"

namespace waymark {

/// The dark pixels of an image as bits, and where borders of dark areas begin. Rows are words of 64
/// bits, of which the first is empty, as are a row above and one below: every pixel has all its
/// neighbours. Keeps its memory from image to image.
class DarkPixels {
 public:
  static constexpr int kWordBits = 64;

  /// Pixels below their tile's threshold are dark; outside the image nothing is. The thresholds are
  /// the image's. Rows have room for `row_px` pixels (not less than the image's; checked): windows
  /// of one image have rows of one length.
  void find(const GrayView& image, const TileThresholds& thresholds, int row_px);

  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  /// From a row to the next.
  [[nodiscard]] int row_words() const { return row_words_; }
  /// The bit of a pixel in `bits` and `starts`: word / 64, from the lowest on.
  [[nodiscard]] std::int64_t bit_of(int x, int y) const {
    return (std::int64_t{y} + 1) * row_words_ * kWordBits + kWordBits + x;
  }
  [[nodiscard]] const std::vector<std::uint64_t>& bits() const { return bits_; }
  [[nodiscard]] bool is_dark(int x, int y) const {
    const std::int64_t bit = bit_of(x, y);
    return (bits_[static_cast<std::size_t>(bit / kWordBits)] >> (bit % kWordBits) & 1U) != 0;
  }

  /// Dark pixels with none dark to the left, above left, above and above right. A dark area's outer
  /// border passes the area's uppermost pixels, of which the first is among them. Left out are
  /// those below pixels just as dark whose tile has no threshold.
  [[nodiscard]] const std::vector<std::uint64_t>& starts() const { return starts_; }

 private:
  void resize(int width_px, int height_px, int row_px);
  void find_starts(int y, const TileThresholds& thresholds);

  int width_px_ = 0;
  int height_px_ = 0;
  int words_ = 0;  ///< of a row, that hold pixels
  int row_words_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint64_t> starts_;
  // Of one row's pixels.
  std::vector<std::uint8_t> threshold_;
  std::vector<std::uint8_t> dark_;
};

}  // namespace waymark
