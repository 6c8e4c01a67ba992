#include "simulator/point_spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "core/base/check.h"
#include "simulator/vector_clones.h"

namespace waymark::simulator {
namespace {

/// (2·radius + 1)·oversampling at most: 5 px of lens, 5 px of defocus, 8 sub-pixels.
constexpr std::size_t kMostTaps = 512;

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// Pixels whose sums are held in registers together.
constexpr std::size_t kBlock = 16;

/// out[x] = Σ weights[k]·inputs[k][x], added in the order of k.
WAYMARK_VECTOR_CLONES void weighted_sum(std::span<const float* const> inputs, const float* weights,
                                        std::size_t count, float* out) {
  std::size_t x = 0;
  for (; x + kBlock <= count; x += kBlock) {
    std::array<float, kBlock> sums{};
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      const float weight = weights[k];
      const float* in = inputs[k] + x;
      for (std::size_t i = 0; i < kBlock; ++i) sums[i] += weight * in[i];
    }
    std::copy(sums.begin(), sums.end(), out + x);
  }
  for (; x < count; ++x) {
    float sum = 0;
    for (std::size_t k = 0; k < inputs.size(); ++k) sum += weights[k] * inputs[k][x];
    out[x] = sum;
  }
}

}  // namespace

int PointSpread::radius_px(double sigma_px) {
  // Beyond 3.6 sigma and half a pixel lie 0.03 % of the light.
  return static_cast<int>(std::ceil(3.6 * sigma_px + 0.4));
}

PointSpread::PointSpread(double sigma_px, int oversampling) : oversampling_(oversampling) {
  // A sub-pixel's light sits in its middle here but was collected over its width: that much blur is
  // there already.
  const double width_px = 1.0 / oversampling;
  const double sigma =
      std::sqrt(std::max(sigma_px * sigma_px - width_px * width_px / 12.0, 0.0025));
  const int taps = (2 * radius_px(sigma_px) + 1) * oversampling;
  WAYMARK_CHECK(static_cast<std::size_t>(taps) <= kMostTaps);
  std::vector<double> weights;
  for (int i = 0; i < taps; ++i) {
    const double from_centre_px = (i + 0.5 - 0.5 * taps) * width_px;
    weights.push_back(normal_cdf((0.5 - from_centre_px) / sigma) -
                      normal_cdf((-0.5 - from_centre_px) / sigma));
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (const double weight : weights) weights_.push_back(static_cast<float>(weight / sum));
}

void PointSpread::reduce_row(const float* phases, std::size_t stride, std::size_t count,
                             float* out) const {
  const auto n = static_cast<std::size_t>(oversampling_);
  std::array<const float*, kMostTaps> inputs;
  for (std::size_t first = 0; first < weights_.size(); first += n) {
    for (std::size_t p = 0; p < n; ++p) inputs[first + p] = phases + p * stride + first / n;
  }
  weighted_sum({inputs.data(), weights_.size()}, weights_.data(), count, out);
}

void PointSpread::reduce_column(const float* rows, std::size_t stride, std::size_t count,
                                float* out) const {
  std::array<const float*, kMostTaps> inputs;
  for (std::size_t tap = 0; tap < weights_.size(); ++tap) inputs[tap] = rows + tap * stride;
  weighted_sum({inputs.data(), weights_.size()}, weights_.data(), count, out);
}

}  // namespace waymark::simulator
