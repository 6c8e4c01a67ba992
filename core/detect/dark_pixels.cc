#include "core/detect/dark_pixels.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/base/check.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace waymark {
namespace {

static_assert(std::endian::native == std::endian::little, "a word's first byte is its lowest");

void spread_over_pixels(const std::uint8_t* tiles, int columns, std::uint8_t* pixels) {
  static_assert(TileThresholds::kTilePx == sizeof(std::uint32_t));
  for (int i = 0; i < columns; ++i) {
    const std::uint32_t four = tiles[i] * 0x01010101U;
    std::memcpy(pixels + 4 * static_cast<std::ptrdiff_t>(i), &four, sizeof four);
  }
}

void compare(const std::uint8_t* pixels, const std::uint8_t* thresholds, int width,
             std::uint8_t* __restrict dark) {
  for (int x = 0; x < width; ++x) dark[x] = pixels[x] < thresholds[x] ? 0xFF : 0;
}

/// The bits of 64 bytes that are 0 or 255.
std::uint64_t packed(const std::uint8_t* bytes) {
  std::uint64_t bits = 0;
#if defined(__SSE2__)
  for (int i = 0; i < 4; ++i) {
    const __m128i lanes =
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes + std::ptrdiff_t{16} * i));
    bits |= static_cast<std::uint64_t>(_mm_movemask_epi8(lanes)) << (16 * i);
  }
#else
  for (int i = 0; i < 8; ++i) {
    std::uint64_t eight;
    std::memcpy(&eight, bytes + std::ptrdiff_t{8} * i, sizeof eight);
    // Byte k's bit comes to lie at 56 + k; no other sum reaches there.
    bits |= ((eight & 0x0101010101010101U) * 0x0102040810204080U >> 56) << (8 * i);
  }
#endif
  return bits;
}

}  // namespace

void DarkPixels::resize(int width_px, int height_px, int row_px) {
  const int row_words = 1 + (row_px + kWordBits - 1) / kWordBits;
  if (width_px == width_px_ && height_px == height_px_ && row_words == row_words_) return;
  width_px_ = width_px;
  height_px_ = height_px;
  words_ = (width_px + kWordBits - 1) / kWordBits;
  row_words_ = row_words;
  const std::size_t all =
      static_cast<std::size_t>(row_words_) * (static_cast<std::size_t>(height_px) + 2) + 1;
  bits_.assign(all, 0);
  starts_.assign(all, 0);
  const std::size_t row_bytes = static_cast<std::size_t>(words_) * kWordBits;
  threshold_.assign(row_bytes, 0);
  dark_.assign(row_bytes, 0);
}

/// A start below a pixel without threshold is the edge of what has one, and no edge of the image's,
/// where that pixel is as dark.
void DarkPixels::find_starts(int y, const TileThresholds& thresholds) {
  const std::size_t first =
      static_cast<std::size_t>(row_words_) * (static_cast<std::size_t>(y) + 1) + 1;
  const std::uint64_t* here = bits_.data() + first;
  const std::uint64_t* above = here - row_words_;
  std::uint64_t* starts = starts_.data() + first;
  for (int i = 0; i < words_; ++i) {
    const std::uint64_t left = here[i] << 1 | here[i - 1] >> 63;
    const std::uint64_t right = here[i] >> 1 | here[i + 1] << 63;
    const std::uint64_t above_right = above[i] >> 1 | above[i + 1] << 63;
    starts[i] = here[i] & ~(left | above[i] | (right & above_right));
  }
  if (y == 0 || y % TileThresholds::kTilePx != 0) return;
  for (int i = 0; i < words_; ++i) {
    for (std::uint64_t rest = starts[i]; rest != 0; rest &= rest - 1) {
      const int x = i * kWordBits + std::countr_zero(rest);
      if (thresholds.at_pixel(x, y - 1) == TileThresholds::kNone &&
          thresholds.middle_at_pixel(x, y - 1) < thresholds.at_pixel(x, y)) {
        starts[i] &= ~(rest & -rest);
      }
    }
  }
}

void DarkPixels::find(const GrayView& image, const TileThresholds& thresholds, int row_px) {
  WAYMARK_CHECK(row_px >= image.width_px);
  resize(image.width_px, image.height_px, row_px);
  for (int y = 0; y < height_px_; ++y) {
    if (y % TileThresholds::kTilePx == 0) {
      spread_over_pixels(thresholds.row(y / TileThresholds::kTilePx), thresholds.columns(),
                         threshold_.data());
    }
    compare(image.row(y), threshold_.data(), width_px_, dark_.data());
    std::uint64_t* row = bits_.data() + bit_of(0, y) / kWordBits;
    for (int i = 0; i < words_; ++i) {
      row[i] = packed(dark_.data() + static_cast<std::ptrdiff_t>(kWordBits) * i);
    }
    find_starts(y, thresholds);
  }
}

}  // namespace waymark
