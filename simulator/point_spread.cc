#include "simulator/point_spread.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace waymark::simulator {
namespace {

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

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
  std::fill_n(out, count, 0.0F);
  const auto n = static_cast<std::size_t>(oversampling_);
  for (std::size_t tap = 0; tap < weights_.size(); ++tap) {
    const float weight = weights_[tap];
    const float* in = phases + (tap % n) * stride + tap / n;
    for (std::size_t x = 0; x < count; ++x) out[x] += weight * in[x];
  }
}

void PointSpread::reduce_column(const float* rows, std::size_t stride, std::size_t count,
                                float* out) const {
  std::fill_n(out, count, 0.0F);
  for (std::size_t tap = 0; tap < weights_.size(); ++tap) {
    const float weight = weights_[tap];
    const float* in = rows + tap * stride;
    for (std::size_t x = 0; x < count; ++x) out[x] += weight * in[x];
  }
}

}  // namespace waymark::simulator
