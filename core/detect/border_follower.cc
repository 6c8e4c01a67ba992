#include "core/detect/border_follower.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/base/check.h"

namespace waymark {
namespace {

// Directions to a pixel's eight neighbours, clockwise as the image shows it.
constexpr int kDirections = 8;
constexpr std::array<int, kDirections> kStepX{1, 1, 0, -1, -1, -1, 0, 1};
constexpr std::array<int, kDirections> kStepY{0, 1, 1, 1, 0, -1, -1, -1};

constexpr int kPatterns = 512;  // of 3×3 pixels
constexpr std::int64_t kDirectionMask = std::int64_t{kDirections - 1} * kPatterns;

/// Whether the neighbour is dark: patterns go row by row, the lowest bit is above left.
bool is_dark(unsigned pattern, std::size_t direction) {
  const int bit = 3 * (kStepY[direction] + 1) + kStepX[direction] + 1;
  return (pattern >> bit & 1U) != 0;
}

/// Whether the pixel in that direction is of the same area: diagonally by way of another.
bool is_connected(unsigned pattern, std::size_t direction) {
  if (!is_dark(pattern, direction)) return false;
  return direction % 2 == 0 || is_dark(pattern, (direction + 1) % kDirections) ||
         is_dark(pattern, direction - 1);
}

/// Where a border goes on from the middle of a pattern; `arriving` where nothing else is dark.
/// The light is on the left: whoever came in direction d has not seen what lies from d − 3 on.
std::size_t direction_from(std::size_t arriving, unsigned pattern) {
  for (std::size_t turn = kDirections - 3; turn <= kDirections + 4; ++turn) {
    const std::size_t direction = (arriving + turn) % kDirections;
    if (is_connected(pattern, direction)) return direction;
  }
  return arriving;
}

/// Three pixels of a row, from a bit on.
unsigned three_at(const std::uint8_t* bytes, std::int64_t bit) {
  std::uint16_t sixteen;
  std::memcpy(&sixteen, bytes + (bit >> 3), sizeof sixteen);
  return static_cast<unsigned>(sixteen) >> (bit & 7) & 7U;
}

}  // namespace

void BorderFollower::make_table() {
  for (std::size_t arriving = 0; arriving < kDirections; ++arriving) {
    for (unsigned pattern = 0; pattern < kPatterns; ++pattern) {
      const std::size_t direction = direction_from(arriving, pattern);
      const std::int64_t step =
          !is_connected(pattern, direction)
              ? 0
              : std::int64_t{kStepY[direction]} * row_words_ * DarkPixels::kWordBits +
                    kStepX[direction];
      table_[arriving * kPatterns + pattern] =
          step * (std::int64_t{1} << 32) + static_cast<std::int64_t>(direction) * kPatterns;
    }
  }
}

void BorderFollower::begin(const DarkPixels& pixels) {
  WAYMARK_CHECK(pixels.width_px() < kSizeLimitPx && pixels.height_px() < kSizeLimitPx);
  dark_ = &pixels;
  if (row_words_ != pixels.row_words()) {
    row_words_ = pixels.row_words();
    make_table();
  }
  starts_ = pixels.starts();
  word_ = 0;
  pixels_.resize(
      std::bit_ceil(2 * static_cast<std::size_t>(pixels.width_px() + pixels.height_px())));
}

std::span<const Pixel> BorderFollower::next() {
  for (; word_ < starts_.size(); ++word_) {
    while (starts_[word_] != 0) {
      const int bit = std::countr_zero(starts_[word_]);
      const auto row = static_cast<int>(word_) / row_words_;
      const int column = (static_cast<int>(word_) % row_words_ - 1) * DarkPixels::kWordBits + bit;
      const auto border =
          follow(static_cast<std::int64_t>(word_) * DarkPixels::kWordBits + bit,
                 {static_cast<std::int16_t>(column), static_cast<std::int16_t>(row - 1)});
      if (!border.empty()) return border;
    }
  }
  return {};
}

/// Empty for a single pixel and for borders that are too long.
std::span<const Pixel> BorderFollower::follow(std::int64_t start, Pixel place) {
  // Nothing is dark from the left clockwise to above right: as if one came from below right.
  constexpr std::int64_t kArriving = std::int64_t{7} * kPatterns;
  std::array<std::int32_t, kDirections> steps;
  for (std::size_t d = 0; d < kDirections; ++d) steps[d] = kStepX[d] + kStepY[d] * 0x10000;

  const auto row_bits = std::int64_t{row_words_} * DarkPixels::kWordBits;
  const auto* const above =
      reinterpret_cast<const std::uint8_t*>(dark_->bits().data() - row_words_);
  const auto* const here = reinterpret_cast<const std::uint8_t*>(dark_->bits().data());
  const auto* const below = here + row_bits / 8;
  const std::int64_t* const table = table_.data();
  std::uint64_t* const starts = starts_.data();
  Pixel* const pixels = pixels_.data();
  const std::size_t mask = pixels_.size() - 1;
  const auto step_from = [&](std::int64_t bit, std::int64_t arriving) {
    const std::int64_t left = bit - 1;
    const unsigned pattern =
        three_at(above, left) | three_at(here, left) << 3 | three_at(below, left) << 6;
    return table[arriving + pattern];
  };

  const std::int64_t first = step_from(start, kArriving) & kDirectionMask;
  std::int64_t bit = start;
  std::int64_t arriving = kArriving;
  auto packed = std::bit_cast<std::int32_t>(place);
  std::size_t count = 0;
  while (true) {
    const std::int64_t step = step_from(bit, arriving);
    arriving = step & kDirectionMask;
    if (bit == start && count != 0 && arriving == first) break;
    pixels[count & mask] = std::bit_cast<Pixel>(packed);
    ++count;
    starts[bit / DarkPixels::kWordBits] &= ~(std::uint64_t{1} << (bit % DarkPixels::kWordBits));
    packed += steps[static_cast<std::size_t>(arriving / kPatterns)];
    bit += step >> 32;
  }
  if (count == 1 || count > pixels_.size()) return {};
  return {pixels, count};
}

}  // namespace waymark
