#pragma once

#include <span>

namespace waymark {

/// How sure corners really are, learnt from their residuals: the model's own error σ (px, per axis)
/// that is added to what the detector states (calibration, print, flatness; everything, where the
/// detector states nothing). Follows the median, so that up to half of the corners may be wrong.
class CornerNoise {
 public:
  /// Starts carefully; `stated` tells whether detections carry covariances.
  explicit CornerNoise(bool stated = true);

  [[nodiscard]] double model_sigma_px() const { return sigma_px_; }
  /// Before so many sets the start value decides.
  [[nodiscard]] bool settled() const { return sets_ >= kSettledSets; }

  /// Takes one set: the squared residuals (sigmas², 8 degrees of freedom each) of its mapped,
  /// unquarantined markers at the pose they gave, and the mean variance (px² per axis) that the
  /// detector stated for their corners. Reorders the residuals. Fewer than two markers tell
  /// nothing.
  void update(std::span<double> sigmas_squared, double stated_variance_px2);

  static constexpr int kSettledSets = 10;
  static constexpr double kSmallest_px = 0.003;
  static constexpr double kLargest_px = 5.0;

 private:
  double sigma_px_;
  int sets_ = 0;
};

}  // namespace waymark
