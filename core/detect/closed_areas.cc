#include "core/detect/closed_areas.h"

#include <algorithm>
#include <array>

namespace waymark {
namespace {

/// The pick of all pixels up to `radius` away in the row.
template <typename Pick>
GrayImage along_rows(const GrayImage& image, int radius, const Pick& pick) {
  GrayImage result = image;
  const int width = image.width_px;
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* const pixels = image.row(y);
    std::uint8_t* const picked = result.row(y);
    for (int by = 1; by <= std::min(radius, width - 1); ++by) {
      for (int x = 0; x < width - by; ++x) picked[x] = pick(picked[x], pixels[x + by]);
      for (int x = by; x < width; ++x) picked[x] = pick(picked[x], pixels[x - by]);
    }
  }
  return result;
}

/// The same in the column.
template <typename Pick>
GrayImage along_columns(const GrayImage& image, int radius, const Pick& pick) {
  GrayImage result = image;
  for (int y = 0; y < image.height_px; ++y) {
    const int last = std::min(image.height_px - 1, y + radius);
    std::uint8_t* const picked = result.row(y);
    for (int other = std::max(0, y - radius); other <= last; ++other) {
      const std::uint8_t* const pixels = image.row(other);
      for (int x = 0; x < image.width_px; ++x) picked[x] = pick(picked[x], pixels[x]);
    }
  }
  return result;
}

template <typename Pick>
GrayImage around(const GrayImage& image, int radius, const Pick& pick) {
  return along_columns(along_rows(image, radius, pick), radius, pick);
}

}  // namespace

int dividing_grey(const GrayView& image) {
  std::array<double, 256> counts{};
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) ++counts[image.row(y)[x]];
  }
  double all = 0;
  double sum = 0;
  for (std::size_t grey = 0; grey < counts.size(); ++grey) {
    all += counts[grey];
    sum += counts[grey] * static_cast<double>(grey);
  }
  int best = 0;
  double most = 0;
  double below = 0;
  double sum_below = 0;
  for (std::size_t grey = 0; grey < counts.size(); ++grey) {
    below += counts[grey];
    sum_below += counts[grey] * static_cast<double>(grey);
    const double above = all - below;
    if (below == 0 || above == 0) continue;
    const double apart = sum_below / below - (sum - sum_below) / above;
    const double between = below * above * apart * apart;
    if (between <= most) continue;
    most = between;
    best = static_cast<int>(grey);
  }
  return best;
}

GrayImage closed(const GrayImage& image, int radius_px) {
  const auto brighter = [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); };
  const auto darker = [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); };
  return around(around(image, radius_px, brighter), radius_px, darker);
}

}  // namespace waymark
