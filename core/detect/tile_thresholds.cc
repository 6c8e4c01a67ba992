#include "core/detect/tile_thresholds.h"

#include <algorithm>
#include <array>

#include "core/base/check.h"

namespace waymark {
namespace {

constexpr int kTile = TileThresholds::kTilePx;

/// The least and the greatest of four rows' pixels, column by column.
void extremes_of_rows(const std::array<const std::uint8_t*, kTile>& rows, int width,
                      std::uint8_t* low, std::uint8_t* high) {
  const auto [a, b, c, d] = rows;
  for (int x = 0; x < width; ++x) {
    low[x] = std::min(std::min(a[x], b[x]), std::min(c[x], d[x]));
    high[x] = std::max(std::max(a[x], b[x]), std::max(c[x], d[x]));
  }
}

void least_of_fours(const std::uint8_t* values, int count, std::uint8_t* least) {
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* four = values + std::ptrdiff_t{kTile} * i;
    least[i] = std::min(std::min(four[0], four[1]), std::min(four[2], four[3]));
  }
}

void greatest_of_fours(const std::uint8_t* values, int count, std::uint8_t* greatest) {
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* four = values + std::ptrdiff_t{kTile} * i;
    greatest[i] = std::max(std::max(four[0], four[1]), std::max(four[2], four[3]));
  }
}

/// of[i] = pick of values[i − 1 … i + 1] where they exist; at least one.
template <typename Pick>
void pick_of_threes(const std::uint8_t* values, int count, std::uint8_t* of, const Pick& pick) {
  if (count == 1) {
    of[0] = values[0];
    return;
  }
  of[0] = pick(values[0], values[1]);
  for (int i = 1; i < count - 1; ++i) of[i] = pick(pick(values[i - 1], values[i]), values[i + 1]);
  of[count - 1] = pick(values[count - 2], values[count - 1]);
}

struct Least {
  std::uint8_t operator()(std::uint8_t a, std::uint8_t b) const { return std::min(a, b); }
};
struct Greatest {
  std::uint8_t operator()(std::uint8_t a, std::uint8_t b) const { return std::max(a, b); }
};

/// The pick of the 3×3 tiles around each.
template <typename Pick>
void pick_of_neighbours(const std::vector<std::uint8_t>& tiles, int columns, int rows,
                        std::uint8_t* line, std::vector<std::uint8_t>& near, const Pick& pick) {
  const auto stride = static_cast<std::size_t>(columns);
  for (int row = 0; row < rows; ++row) {
    const std::uint8_t* here = tiles.data() + static_cast<std::size_t>(row) * stride;
    const std::uint8_t* above = row > 0 ? here - stride : here;
    const std::uint8_t* below = row + 1 < rows ? here + stride : here;
    for (int i = 0; i < columns; ++i) line[i] = pick(pick(above[i], here[i]), below[i]);
    pick_of_threes(line, columns, near.data() + static_cast<std::size_t>(row) * stride, pick);
  }
}

}  // namespace

void TileThresholds::measure_tiles(const GrayView& image) {
  for (int row = 0; row < rows_; ++row) {
    std::array<const std::uint8_t*, kTile> rows;
    for (int i = 0; i < kTile; ++i) {
      rows[static_cast<std::size_t>(i)] = image.row(std::min(kTile * row + i, image.height_px - 1));
    }
    extremes_of_rows(rows, image.width_px, low_.data(), high_.data());
    // The last tile may be a narrow one: its last pixel stands for what is missing.
    for (int x = image.width_px; x < kTile * columns_; ++x) {
      low_[static_cast<std::size_t>(x)] = low_[static_cast<std::size_t>(image.width_px) - 1];
      high_[static_cast<std::size_t>(x)] = high_[static_cast<std::size_t>(image.width_px) - 1];
    }
    least_of_fours(low_.data(), columns_, darkest_.data() + index(row));
    greatest_of_fours(high_.data(), columns_, brightest_.data() + index(row));
  }
}

void TileThresholds::widen() {
  pick_of_neighbours(darkest_, columns_, rows_, low_.data(), darkest_near_, Least{});
  pick_of_neighbours(brightest_, columns_, rows_, low_.data(), brightest_near_, Greatest{});
}

void TileThresholds::look_at(const GrayView& image) {
  WAYMARK_CHECK(image.width_px >= kTile && image.height_px >= kTile);
  columns_ = (image.width_px + kTile - 1) / kTile;
  rows_ = (image.height_px + kTile - 1) / kTile;
  for (auto* tiles : {&darkest_, &brightest_, &darkest_near_, &brightest_near_, &thresholds_}) {
    tiles->resize(index(rows_));
  }
  low_.resize(static_cast<std::size_t>(kTile * columns_));
  high_.resize(low_.size());
  measure_tiles(image);
  widen();
}

void TileThresholds::add_places_to(ContrastGates& gates) const {
  for (int row = 1; row < rows_; row += 3) {
    for (int column = 1; column < columns_; column += 3) {
      const std::size_t i = index(row) + static_cast<std::size_t>(column);
      gates.add(darkest_near_[i], brightest_near_[i]);
    }
  }
}

void TileThresholds::decide(const ContrastGates& gates) {
  for (std::size_t i = 0; i < thresholds_.size(); ++i) {
    const std::uint8_t low = darkest_near_[i];
    const std::uint8_t high = brightest_near_[i];
    const auto threshold = static_cast<std::uint8_t>((5 * high + 3 * low + 4) / 8);
    thresholds_[i] = high - low >= gates.at(high) ? threshold : kNone;
  }
}

void TileThresholds::measure(const GrayView& image, ContrastGates& gates) {
  look_at(image);
  add_places_to(gates);
  gates.settle();
  decide(gates);
}

std::uint8_t TileThresholds::middle_at_pixel(int x, int y) const {
  const std::size_t i = index(y / kTile) + static_cast<std::size_t>(x / kTile);
  return static_cast<std::uint8_t>((darkest_near_[i] + brightest_near_[i]) / 2);
}

}  // namespace waymark
