#include "core/detect/binomial_smoothing.h"

#include <algorithm>
#include <utility>

namespace waymark {
namespace {

void weigh_along(const std::uint8_t* pixels, int width, std::uint16_t* __restrict sums) {
  const auto sum = [&](int left, int here, int right) {
    return static_cast<std::uint16_t>(pixels[left] + 2 * pixels[here] + pixels[right]);
  };
  sums[0] = sum(0, 0, std::min(1, width - 1));
  for (int x = 1; x < width - 1; ++x) sums[x] = sum(x - 1, x, x + 1);
  sums[width - 1] = sum(std::max(0, width - 2), width - 1, width - 1);
}

void weigh_across(const std::uint16_t* above, const std::uint16_t* here, const std::uint16_t* below,
                  int width, std::uint8_t* __restrict pixels) {
  for (int x = 0; x < width; ++x) {
    const auto sum = static_cast<std::uint16_t>(above[x] + 2 * here[x] + below[x] + 8);
    pixels[x] = static_cast<std::uint8_t>(sum >> 4);
  }
}

}  // namespace

GrayView BinomialSmoothing::smoothed(const GrayView& image) {
  const int width = image.width_px;
  const int height = image.height_px;
  result_.width_px = width;
  result_.height_px = height;
  result_.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (auto& row : rows_) row.resize(static_cast<std::size_t>(width));
  auto* above = &rows_[0];
  auto* here = &rows_[1];
  auto* below = &rows_[2];
  weigh_along(image.row(0), width, here->data());
  *above = *here;
  for (int y = 0; y < height; ++y) {
    weigh_along(image.row(std::min(y + 1, height - 1)), width, below->data());
    weigh_across(above->data(), here->data(), below->data(), width, result_.row(y));
    std::swap(above, here);
    std::swap(here, below);
  }
  return result_.view();
}

}  // namespace waymark
