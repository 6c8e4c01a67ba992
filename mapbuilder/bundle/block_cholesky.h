#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapbuilder/bundle/block_matrix.h"

namespace waymark {

/// Sparse Cholesky factor P A Pᵀ = L Lᵀ of a symmetric positive definite matrix of 6×6 blocks,
/// ordered by approximate minimum degree of the block graph. The symbolic part depends on the
/// pattern alone and serves many factorizations. One thread, one order of sums: same input, same
/// bits.
class BlockCholesky {
 public:
  explicit BlockCholesky(const BlockPattern& pattern);

  /// False when `a` (of the constructor's pattern) is not positive definite; then nothing else may
  /// be asked.
  [[nodiscard]] bool factorize(const BlockMatrix& a);

  /// A⁻¹ B; six rows of B per block.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

  /// The diagonal blocks of A⁻¹, by the recursion over the factor's own pattern (Takahashi, Fagan
  /// and Chin, 1973), without the full inverse.
  [[nodiscard]] std::vector<Matrix6d> inverse_diagonal() const;

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] std::size_t factor_blocks() const { return rows_.size(); }

 private:
  void analyse(const BlockPattern& pattern);

  int columns_ = 0;
  std::vector<int> position_;  ///< of the original block in the permuted matrix
  // L by columns: the diagonal block apart, the rest by rising row.
  std::vector<int> first_;
  std::vector<int> rows_;
  std::vector<Matrix6d> below_;
  std::vector<Matrix6d> diagonal_;          ///< lower triangular
  std::vector<Matrix6d> diagonal_inverse_;  ///< lower triangular
  /// Per column: the columns to its left with a block in its row, and where that block stands.
  std::vector<int> left_first_;
  std::vector<int> left_column_;
  std::vector<int> left_block_;
};

}  // namespace waymark
