#include "locd/pose/corner_noise.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace waymark {
namespace {

/// Until the first set tells: several times the detector's own error, or what untreated corners
/// have.
constexpr double kStartStated_px = 0.06;
constexpr double kStartUnstated_px = 0.5;
/// Sets that are remembered.
constexpr double kMemorySets = 200;
/// One set may raise the variance by so much at most.
constexpr double kLargestRatio = 4.0;

/// How far below what the detector states (a share of its variance) the memory may fall.
constexpr double kLowest = 0.2;

/// Cameras that agree with themselves so much worse than the best one are not asked.
constexpr double kWorseThanBest = 6.0;

/// What the median of a camera's squared residuals is on average, where σ is right. The pose took 6
/// of the 8n degrees of freedom, which leaves each marker k = 8 − 6/n; of two χ²ₖ the median is the
/// mean, of many 0.918 k (order statistics, integrated numerically).
double expected_median(int markers) {
  constexpr std::array<double, 6> kOfFew{1.0, 0.940, 0.945, 0.932, 0.934, 0.928};
  const auto index = static_cast<std::size_t>(markers - 2);
  const double share = index < kOfFew.size() ? kOfFew[index] : 0.918 + 0.08 / markers;
  return share * (8.0 - 6.0 / markers);
}

double ratio_of(const CornerNoise::CameraResiduals& camera) {
  return camera.median / expected_median(camera.markers);
}

}  // namespace

CornerNoise::CornerNoise(bool stated)
    : sigma_px_(stated ? kStartStated_px : kStartUnstated_px),
      variance_px2_(sigma_px_ * sigma_px_) {}

void CornerNoise::update(std::span<const CameraResiduals> cameras, double stated_variance_px2) {
  double best = kLargestRatio;
  for (const CameraResiduals& camera : cameras) best = std::min(best, ratio_of(camera));
  double sum = 0;
  double markers = 0;
  for (const CameraResiduals& camera : cameras) {
    const double ratio = ratio_of(camera);
    if (ratio > kWorseThanBest * std::max(best, 0.1)) continue;
    sum += camera.markers * std::min(ratio, kLargestRatio);
    markers += camera.markers;
  }
  if (markers == 0) return;
  markers_ += markers;
  // A running mean over markers, which becomes one that forgets.
  const double gain = std::max(markers / markers_, markers / (markers + 4.0) / kMemorySets);
  const double measured = sum / markers * (stated_variance_px2 + sigma_px_ * sigma_px_);
  variance_px2_ += gain * (measured - stated_variance_px2 - variance_px2_);
  // Remembered below zero as well: what is cut off at every set would make the mean too large.
  variance_px2_ =
      std::clamp(variance_px2_, -kLowest * stated_variance_px2, kLargest_px * kLargest_px);
  sigma_px_ = std::sqrt(std::max(variance_px2_, kSmallest_px * kSmallest_px));
}

}  // namespace waymark
