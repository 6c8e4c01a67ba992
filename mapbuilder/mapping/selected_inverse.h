#pragma once

#include <Eigen/SparseCore>
#include <optional>

namespace waymark {

/// Entries of A⁻¹ on the pattern of A's Cholesky factor, for a sparse symmetric positive definite
/// A (Takahashi, Fagan and Chin, 1973): everything on A's own pattern, its block diagonal among it,
/// without the full inverse. Also solves with the same factor.
class SelectedInverse {
 public:
  /// nullopt when A is not positive definite.
  [[nodiscard]] static std::optional<SelectedInverse> compute(const Eigen::SparseMatrix<double>& a);

  /// A⁻¹(row, column); 0 outside the factor's pattern, which contains A's pattern.
  [[nodiscard]] double operator()(int row, int column) const;

  /// A⁻¹ B.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

 private:
  SelectedInverse() = default;

  Eigen::SparseMatrix<double> factor_;  ///< unit lower L of P A Pᵀ = L D Lᵀ, strictly lower part
  Eigen::VectorXd pivots_;              ///< D
  Eigen::SparseMatrix<double> inverse_;  ///< lower half on the factor's pattern, permuted
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permuted_from_original_;
};

}  // namespace waymark
