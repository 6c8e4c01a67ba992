#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/detect/dark_pixels.h"

namespace waymark {

/// A pixel's column and row.
struct Pixel {
  std::int16_t x = 0;
  std::int16_t y = 0;

  bool operator==(const Pixel&) const = default;
};

/// Goes round the borders of dark areas (eight neighbours each), the dark on the right hand: round
/// an area clockwise as the image shows it, round a hole counterclockwise. Moore's neighbour
/// tracing with one look-up per step, whose table holds for each way of arriving and each
/// neighbourhood where to go. Keeps its memory from image to image.
class BorderFollower {
 public:
  /// Images are less wide and high.
  static constexpr int kSizeLimitPx = 1 << 15;

  /// Of an image within the limit (checked), which must outlive the following.
  void begin(const DarkPixels& pixels);

  /// The next border's pixels, from the uppermost starts of DarkPixels on; one that is passed twice
  /// comes twice. Every outer border comes once, and of holes some. Left out are single pixels, and
  /// borders longer than any convex one in the image. Empty at the end. Valid until the next call.
  [[nodiscard]] std::span<const Pixel> next();

 private:
  void make_table();
  [[nodiscard]] std::span<const Pixel> follow(std::int64_t start, Pixel place);

  const DarkPixels* dark_ = nullptr;
  int row_words_ = 0;
  /// By (arriving direction · 512 + 3×3 pixels): the step's change of the bit (upper half), and the
  /// direction gone in · 512 (lower half).
  std::array<std::int64_t, std::size_t{8} * 512> table_{};
  std::vector<std::uint64_t> starts_;  ///< those not passed yet
  std::size_t word_ = 0;               ///< before which none are left
  std::vector<Pixel> pixels_;          ///< a power of two of them
};

}  // namespace waymark
