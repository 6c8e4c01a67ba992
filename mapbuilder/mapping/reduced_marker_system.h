#pragma once

#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "mapbuilder/mapping/map_state.h"

namespace waymark {

/// The normal equations of a map with its rig poses eliminated:
/// S = Σ H_mm − H_mr H_rr⁻¹ H_rm, six rows per marker in Rigid3's tangent. Singular by the six
/// freedoms of the world frame.
struct ReducedMarkerSystem {
  std::vector<int> markers;                 ///< table indices, rising; block i is markers[i]
  Eigen::SparseMatrix<double> information;  ///< symmetric, both halves stored
};

/// Builds it at the state's poses, robustly weighted, over the accepted ones of the given
/// observations.
[[nodiscard]] ReducedMarkerSystem reduce_to_markers(const ObservationTable& table,
                                                    std::span<const std::size_t> observations,
                                                    const ObservationLoss& loss,
                                                    const MapState& state);

/// Marginal covariance of each marker's pose (order of `system.markers`) in the gauge that removes
/// the mean motion of all marker positions: C = P S⁻ Pᵀ with P = I − N (GᵀN)⁻¹ Gᵀ, N the motions of
/// the world, G their position rows (of positions on a line: all rows, else the turn about the line
/// is undetermined). S⁻ fixes one marker; its block diagonal comes from a selected inversion of the
/// sparse factor (Takahashi, 1973). Empty when S is not positive definite without the six freedoms:
/// the map has looser parts.
[[nodiscard]] std::vector<Matrix6d> marker_covariances(const ReducedMarkerSystem& system,
                                                       const MapState& state);

}  // namespace waymark
