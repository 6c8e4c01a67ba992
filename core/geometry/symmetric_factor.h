#pragma once

#include <Eigen/Cholesky>

namespace waymark {

/// Factorization LDLᵀ of a symmetric matrix: Eigen's, compiled once, for it takes seconds of a
/// build in every file that uses it. N is 3, 6, 7, 12 or 21, or 8 and 9
/// for `solve` alone. No allocation.
template <int N>
class SymmetricFactor {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  explicit SymmetricFactor(const Matrix& symmetric);

  [[nodiscard]] Vector solve(const Vector& right) const;
  /// One solution per column.
  [[nodiscard]] Matrix solve_columns(const Matrix& right) const;
  [[nodiscard]] Matrix inverse() const;

 private:
  Eigen::LDLT<Matrix> factor_;
};

}  // namespace waymark
