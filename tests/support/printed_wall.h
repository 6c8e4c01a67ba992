#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/capture/gray_image.h"
#include "core/marker/marker_bits.h"

namespace waymark::test {

/// How markers were printed and hung.
struct Print {
  Family family = Family::tag36h11;
  std::vector<int> numbers = {0, 1, 2, 3, 4, 5, 6, 7};
  double border_cells = 1;
  double margin_cells = 1;
  bool inverted = false;  ///< white on black
  double side_px = 80;    ///< of the marker's square
  double black = 35;
  double white = 215;
  double wall = 120;
};

/// Draws one print, its middle at (x, y), turned by `angle`: 3×3 samples per pixel.
inline void draw(const Print& print, int number, double x, double y, double angle,
                 GrayImage& image) {
  constexpr int kSamples = 3;
  const MarkerBits bits = marker_bits({print.family, number});
  const int code = bits.cells - 2;
  const double all = code + 2 * print.border_cells;
  const double cell_px = print.side_px / all;
  const double cosine = std::cos(angle) / cell_px;
  const double sine = std::sin(angle) / cell_px;
  const auto grey_at = [&](double px, double py, double behind) {
    const double right = (px - x) * cosine + (py - y) * sine + all / 2;
    const double down = -(px - x) * sine + (py - y) * cosine + all / 2;
    const auto within = [&](double margin) {
      return right > -margin && right < all + margin && down > -margin && down < all + margin;
    };
    // What is beyond the paper shows.
    if (!within(bits.outside + print.margin_cells)) return behind;
    bool white = !within(bits.outside);
    const int column = static_cast<int>(std::floor(right - print.border_cells)) + 1;
    const int row = static_cast<int>(std::floor(down - print.border_cells)) + 1;
    if (!white && std::min(row, column) >= -bits.outside &&
        std::max(row, column) < bits.cells + bits.outside) {
      const bool has_cell =
          bits.outside > 0 || (std::min(row, column) >= 1 && std::max(row, column) <= code);
      white =
          (has_cell && bits.is_white(row, column)) || bits.kind(row, column) == CellKind::nothing;
    }
    return white != print.inverted ? print.white : print.black;
  };
  const double whole = all + 2 * (bits.outside + print.margin_cells);
  const int reach = static_cast<int>(0.75 * whole * cell_px) + 1;
  const auto from = [&](double middle) { return std::max(0, static_cast<int>(middle) - reach); };
  const auto to = [&](double middle, int size) {
    return std::min(size, static_cast<int>(middle) + reach);
  };
  for (int v = from(y); v < to(y, image.height_px); ++v) {
    for (int u = from(x); u < to(x, image.width_px); ++u) {
      double sum = 0;
      for (int sample = 0; sample < kSamples * kSamples; ++sample) {
        sum += grey_at(u - 0.5 + (sample % kSamples + 0.5) / kSamples,
                       v - 0.5 + (sample / kSamples + 0.5) / kSamples, image.row(v)[u]);
      }
      image.row(v)[u] = static_cast<std::uint8_t>(std::lround(sum / (kSamples * kSamples)));
    }
  }
}

/// A wall with up to eight prints, seen straight on, each turned a little: 640×480, with noise of 2
/// grey values; `step` moves it.
inline GrayImage wall_with(const Print& print, int step) {
  GrayImage image(640, 480, static_cast<std::uint8_t>(print.wall));
  for (std::size_t i = 0; i < print.numbers.size(); ++i) {
    draw(print, print.numbers[i], 90.0 + 150.0 * static_cast<double>(i % 4) + step,
         130.0 + 210.0 * static_cast<double>(i / 4), 0.06 * static_cast<double>(i) - 0.2, image);
  }
  std::mt19937 random(static_cast<unsigned>(step));
  for (std::uint8_t& grey : image.pixels) {
    // The sum of four even draws is near enough to Gaussian.
    const std::uint32_t bits = random();
    const int noise =
        static_cast<int>((bits & 3U) + (bits >> 2 & 3U) + (bits >> 4 & 3U) + (bits >> 6 & 3U)) - 6;
    grey = static_cast<std::uint8_t>(std::clamp(grey + noise, 0, 255));
  }
  return image;
}

/// Left and right exchanged.
inline GrayImage mirrored(GrayImage image) {
  for (int y = 0; y < image.height_px; ++y)
    std::reverse(image.row(y), image.row(y) + image.width_px);
  return image;
}

/// As a lens cap, or no light, leaves it.
inline GrayImage darkened(GrayImage image, double factor) {
  for (std::uint8_t& grey : image.pixels) grey = static_cast<std::uint8_t>(grey * factor);
  return image;
}

}  // namespace waymark::test
