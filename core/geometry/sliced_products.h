#pragma once

#include <Eigen/Core>

/// Products and Cholesky factors of matrices of up to some 500 rows that allocate nothing: done in
/// slices so thin that Eigen's workspace fits its limit on the stack.
namespace waymark {

using MatrixView = Eigen::Ref<Eigen::MatrixXd>;
using ConstMatrixView = Eigen::Ref<const Eigen::MatrixXd>;

/// c += a b
void add_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c);

/// c += aᵀ b
void add_transposed_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c);

/// Of the symmetric positive definite matrix whose lower triangle is given the factor L (L Lᵀ) in
/// its place; what lies above is left. False: it is none.
[[nodiscard]] bool factor_in_place(MatrixView matrix);

/// x ← L⁻¹ x, of the lower triangle of `lower`.
void solve_in_place(const ConstMatrixView& lower, MatrixView x);

}  // namespace waymark
