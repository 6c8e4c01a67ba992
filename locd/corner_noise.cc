#include "locd/corner_noise.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

constexpr double kMedianOfChi8 = 7.344;
/// Until the first set tells: several times the detector's own error, or what untreated corners
/// have.
constexpr double kStartStated_px = 0.06;
constexpr double kStartUnstated_px = 0.5;
/// Sets that are remembered.
constexpr double kMemorySets = 200;
/// One set may raise the variance by so much at most.
constexpr double kLargestRatio = 4.0;

/// Cameras that agree with themselves so much worse than the best one are not asked.
constexpr double kWorseThanBest = 6.0;

/// The pose took 6 of the 8n degrees of freedom.
double ratio_of(const CornerNoise::CameraResiduals& camera) {
  return camera.median * 8.0 * camera.markers / (8.0 * camera.markers - 6.0) / kMedianOfChi8;
}

}  // namespace

CornerNoise::CornerNoise(bool stated) : sigma_px_(stated ? kStartStated_px : kStartUnstated_px) {}

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
  const double variance = sigma_px_ * sigma_px_;
  const double next = variance + gain * (sum / markers - 1.0) * (stated_variance_px2 + variance);
  sigma_px_ = std::sqrt(std::clamp(next, kSmallest_px * kSmallest_px, kLargest_px * kLargest_px));
}

}  // namespace waymark
