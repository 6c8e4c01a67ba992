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
  /// What one camera's markers left in one set when fitted by themselves.
  struct CameraResiduals {
    double median = 0;  ///< of the markers' squared residuals, sigmas², 8 degrees of freedom each
    int markers = 0;    ///< at least 2
  };
  /// Takes one set, with the mean variance (px² per axis) that the detector stated for its corners.
  /// Cameras whose markers agree far worse than those of the best are left out: something else is
  /// wrong with them.
  void update(std::span<const CameraResiduals> cameras, double stated_variance_px2);

  static constexpr double kSmallest_px = 0.003;
  static constexpr double kLargest_px = 5.0;

 private:
  double sigma_px_;
  double variance_px2_;  ///< the running mean behind it, below zero where corners are better
  double markers_ = 0;   ///< taken so far
};

}  // namespace waymark
