#pragma once

#include <array>
#include <span>

#include "core/estimate/marker_observation.h"
#include "core/estimate/observation_weight.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

struct Estimate;
class PreparedObservations;

/// What weighs an observation against another.
enum class Weighting {
  covariance,  ///< inverse corner covariance, the detector's plus the model's error
  paper,       ///< eqs. 7–8
  none,        ///< all alike
};

/// How sure a corner is: Σ = Σ_detector + σ_model² I (covariance), σ_model²/w I (paper), σ_model² I
/// (none). σ_model (px, per axis) stands for what no detector can know: calibration, print,
/// flatness; where the detector states no covariance it carries all. It is estimated from the
/// residuals, so that sigmas mean sigmas.
struct NoiseModel {
  Weighting weighting = Weighting::covariance;
  ObservationWeightOptions paper;
  double model_sigma_px = 1.0;  ///< (kSmallestModelSigma–kLargestModelSigma)

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Bounds of the estimate. Below 0.002 px nothing real is (rendered corners are 0.009 px sure);
/// above 20 px nothing fits. A rig of one camera has no extrinsics that could be wrong, and a lens
/// stated without its distortion leaves 1.5 px (tag_table): more is no noise but a map that a wrong
/// id has bent, and taking it for noise would hide that from the gate.
inline constexpr double kSmallestModelSigma = 0.002;
inline constexpr double kLargestModelSigma = 20.0;
inline constexpr double kLargestModelSigmaOfOneCamera = 3.0;

/// Whitening of the four corners of an observation with these IPPE solutions.
[[nodiscard]] std::array<Eigen::Matrix2d, 4> whitening_of(const Observation& o,
                                                          const std::optional<IppeSolutions>& ippe,
                                                          const NoiseModel& noise);

/// σ_model at which the 90 % quantile of the squared corner residuals (2 degrees of freedom) in
/// sigmas is what Gaussian noise would give (−2 ln 0.1), corrected for `parameter_share`: the
/// number of estimated parameters per residual component, in [0, 1). Corners that are 20 times
/// farther off than the median tells are left out, so up to half may be wrong. Looks at the given
/// observations (both ends posed); without any: the noise model's own value.
[[nodiscard]] double estimate_model_sigma_px(const PreparedObservations& prepared,
                                             const Estimate& estimate,
                                             std::span<const ObservationIndex> observations,
                                             const NoiseModel& noise, double parameter_share);

}  // namespace waymark
