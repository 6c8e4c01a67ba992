#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/bundle/block_matrix.h"

namespace waymark {

/// What is known of a sub-map's markers together: ½ δᵀ N δ (sigmas²), δ six rows a marker, each in
/// the tangent of its place (Rigid3). N is sparse: two markers share a block where frame sets have
/// seen both.
struct MarkerSystem {
  std::vector<Rigid3> world_from_marker;  ///< where δ is 0
  /// The lower half: (row, column) by marker, row ≥ column; every diagonal block is there.
  std::map<std::pair<int, int>, Matrix6d> blocks;
  /// Whether N fixes the world. Otherwise it is singular by the world's six motions.
  bool world_is_fixed = false;

  [[nodiscard]] int markers() const { return static_cast<int>(world_from_marker.size()); }
};

/// N in the form that a Cholesky factor takes.
[[nodiscard]] BlockMatrix block_matrix_of(const MarkerSystem& system);

/// The system of markers that are independent, each with the covariance that the sub-map holds of
/// it. Eigenvalues below (10 µm)² and (10⁻⁵ rad)² count as that: a covariance whose gauge takes
/// directions out is singular, and no paper hangs more surely. An unknown one counts as 0.1 m and
/// 0.1 rad, as locd takes it.
[[nodiscard]] MarkerSystem independent_system(const SubMap& submap);

/// The system of some of its markers, given rising: what the others told of these stays (Schur
/// complement), but for what a marker told that is itself not determined.
[[nodiscard]] MarkerSystem marginal_system(MarkerSystem system, const std::vector<int>& kept);

}  // namespace waymark
