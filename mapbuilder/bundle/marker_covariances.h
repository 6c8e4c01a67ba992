#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/bundle/block_cholesky.h"
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

/// Those of the problem's observations that are accepted and posed, in their order.
[[nodiscard]] std::vector<ObservationIndex> accepted_observations(const BundleProblem& problem,
                                                                  const Estimate& estimate);

/// Builds it at the estimate's poses, robustly weighted, over the accepted observations, no pose
/// constant.
[[nodiscard]] MarkerInformation marker_information(const BundleProblem& problem,
                                                   const Estimate& estimate, int threads);

/// The inverse of the markers' information, the calibration's uncertainty included, in the gauge of
/// a map: in a fixed world N⁻¹ itself, else Γ N⁻ Γᵀ, which removes the mean motion of all marker
/// positions: Γ = I − n (gᵀn)⁻¹ gᵀ, n the motions of the world, g their position rows (of positions
/// on a line: all rows, else the turn about the line is undetermined), and N⁻ with one marker
/// fixed. One thread, one order of sums: same input, same bits.
class MarkerInverse {
 public:
  /// nullopt where N is not positive definite without the six freedoms (something moves against the
  /// rest at no cost), or is of one marker.
  [[nodiscard]] static std::optional<MarkerInverse> of(const MarkerInformation& information);

  /// Γ N⁻¹ B: how the markers answer to right sides that no motion of the world changes. Six rows a
  /// marker.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

  /// Γ N⁻¹ Γᵀ X: the covariance by what stands right of it.
  [[nodiscard]] Eigen::MatrixXd covariance_times(const Eigen::MatrixXd& x) const;

  /// The marginal covariance of each marker's pose (order of MarkerInformation::markers): the
  /// diagonal blocks, from the factor's own pattern.
  [[nodiscard]] std::vector<Matrix6d> diagonal() const;

 private:
  MarkerInverse(const MarkerInformation& information, int anchor);
  [[nodiscard]] bool factorize(const MarkerInformation& information);

  /// N⁻ b, with zero rows for the fixed marker.
  [[nodiscard]] Eigen::MatrixXd solve_free(Eigen::MatrixXd b) const;

  int count_;
  int anchor_;  ///< −1: the world is fixed
  BlockCholesky cholesky_;
  Eigen::MatrixXd motions_;                    ///< n; empty in a fixed world, as the next two
  Eigen::MatrixXd gauge_;                      ///< g
  Matrix6d gauge_inverse_ = Matrix6d::Zero();  ///< (gᵀn)⁻¹
};

/// Those of MarkerInverse; empty where there is none.
[[nodiscard]] std::vector<Matrix6d> marker_covariances(const MarkerInformation& information);

}  // namespace waymark
