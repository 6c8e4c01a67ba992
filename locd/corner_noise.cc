#include "locd/corner_noise.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

constexpr double kMedianOfChi8 = 7.344;
/// A careful start: four times the detector's own error, or what untreated corners have.
constexpr double kStartStated_px = 0.06;
constexpr double kStartUnstated_px = 0.5;
/// Sets that are remembered.
constexpr double kMemorySets = 50;
/// One set may raise the variance by so much at most.
constexpr double kLargestRatio = 4.0;

}  // namespace

CornerNoise::CornerNoise(bool stated) : sigma_px_(stated ? kStartStated_px : kStartUnstated_px) {}

void CornerNoise::update(std::span<double> sigmas_squared, double stated_variance_px2) {
  if (sigmas_squared.size() < 2) return;
  const auto middle =
      sigmas_squared.begin() + static_cast<std::ptrdiff_t>(sigmas_squared.size() / 2);
  std::nth_element(sigmas_squared.begin(), middle, sigmas_squared.end());
  const auto markers = static_cast<double>(sigmas_squared.size());
  // The pose took 6 of 8n degrees of freedom.
  const double of_fit = 8.0 * markers / (8.0 * markers - 6.0);
  const double ratio = std::min(*middle * of_fit / kMedianOfChi8, kLargestRatio);
  ++sets_;
  const double gain = std::max(1.0 / sets_, 1.0 / kMemorySets) * markers / (markers + 4.0);
  const double variance = sigma_px_ * sigma_px_;
  const double next = variance + gain * (ratio - 1.0) * (stated_variance_px2 + variance);
  sigma_px_ = std::sqrt(std::clamp(next, kSmallest_px * kSmallest_px, kLargest_px * kLargest_px));
}

}  // namespace waymark
