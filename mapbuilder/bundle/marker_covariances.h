#pragma once

#include <span>
#include <vector>

#include "mapbuilder/bundle/reduced_problem.h"

namespace waymark {

/// The information that observations hold about the markers, rig poses eliminated:
/// S = Σ H_mm − H_mr H_rr⁻¹ H_rm, six rows per marker in Rigid3's tangent, then the blocks of the
/// variable calibration. Singular by the six freedoms of the world frame unless a survey's
/// points fix it.
struct MarkerInformation {
  std::vector<MarkerIndex> markers;  ///< rising; block i is markers[i]
  std::vector<Rigid3> world_from_marker;
  BlockMatrix information;
  bool world_is_fixed = false;  ///< by surveyed points
};

/// Builds it at the estimate's poses, robustly weighted, over those of the problem's observations
/// that are accepted and posed, no pose constant.
[[nodiscard]] MarkerInformation marker_information(const BundleProblem& problem,
                                                   const Estimate& estimate, int threads);

/// Marginal covariance of each marker's pose (order of `markers`), the calibration's uncertainty
/// included: in a fixed world S⁻¹'s blocks, else in the gauge that removes the
/// mean motion of all marker positions: C = P S⁻ Pᵀ with P = I − N (GᵀN)⁻¹ Gᵀ, N the motions of the
/// world, G their position rows (of positions on a line: all rows, else the turn about the line is
/// undetermined). S⁻ fixes one marker; its block diagonal comes from the factor's own pattern.
/// Empty when S is not positive definite without the six freedoms: something moves against the
/// rest at no cost.
[[nodiscard]] std::vector<Matrix6d> marker_covariances(const MarkerInformation& information);

}  // namespace waymark
