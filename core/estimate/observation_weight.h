#pragma once

#include "core/base/range.h"
#include "core/estimate/ippe.h"

namespace waymark {

/// Constants of eq. 7. Defaults are the paper's (L_all of its Table IV).
struct ObservationWeightOptions {
  double lambda_distance = 1.0;   ///< λ₁
  double lambda_angle = 5.0;      ///< λ₂
  double lambda_ambiguity = 0.1;  ///< λ₃
  double epsilon_rad = 0.1;       ///< ε: how similar the two IPPE rotations count as similar
  double max_distance_m = 15.0;   ///< d_max
  double max_angle_rad = 1.5707963267948966;  ///< θ_max

  static constexpr Range kLambda{0, 1e6};
  static constexpr Range kDivisor{1e-6, 1e6};  ///< of ε, d_max, θ_max
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// The observation weight w(d, θ, r₁, r₂) of eq. 7, as the formula stands:
/// exp(−λ₁(d/d_max)² − λ₂(θ/θ_max)² + λ₃ exp(−|r₁ − r₂|²/(2ε²))).
/// The paper's prose says that small d, small θ and similar rotations lower the weight; its signs
/// say that they raise it, and the formula is what its Table IV can be read by. d is the distance
/// to the marker's centre (m), θ the angle between the marker's normal and the ray back to the
/// camera, |r₁ − r₂| the geodesic angle between the two IPPE rotations (the paper leaves both
/// open), of the better solution. Eq. 8's information is w · I₂ (1/px² where 1 px is the unit).
[[nodiscard]] double observation_weight(const IppeSolutions& solutions,
                                        const ObservationWeightOptions& options);

/// The formula alone.
[[nodiscard]] double observation_weight(double distance_m, double angle_rad,
                                        double rotation_difference_rad,
                                        const ObservationWeightOptions& options);

}  // namespace waymark
