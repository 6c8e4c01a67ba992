#pragma once

#include <span>

#include "mapbuilder/mapping/joint_problem.h"

namespace waymark {

/// Options of the joint adjustment.
struct AdjustmentOptions {
  ObservationLoss loss;
  int max_iterations = 50;           ///< (1–1000)
  double function_tolerance = 1e-6;  ///< relative decrease of the cost that ends it
  /// Levenberg–Marquardt's damping at the start, relative to the diagonal, (1e-16–1). What bends a
  /// large map hardly costs anything: only next to no damping lets the end of an adjustment
  /// converge in such a direction.
  double initial_damping = 1e-6;
  int threads = 1;  ///< ≥ 1; never changes the result
};

/// How an adjustment ended.
struct AdjustmentSummary {
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0;  ///< ½ Σ ρ, sigmas²
  double final_cost = 0;
  std::size_t observations = 0;  ///< that took part
};

/// Equation 11: all placed markers and all localized frame sets together, extrinsics and
/// intrinsics fixed, by Levenberg–Marquardt over the reduced marker system. Uses the given
/// observations as far as both their ends are posed, they are accepted and not grossly off, and
/// their frame set has at least two of them (a single one only fixes its own rig). Updates the
/// poses of the state that are not held.
AdjustmentSummary adjust_jointly(const ObservationTable& table,
                                 std::span<const std::size_t> observations, const HeldPoses& held,
                                 const AdjustmentOptions& options, MapState& state);

}  // namespace waymark
