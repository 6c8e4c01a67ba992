#pragma once

#include <Eigen/Core>

/// Products and Cholesky factors of matrices of up to some 500 rows, for programs that must not
/// allocate: Eigen's own take memory for each. They use wider vector instructions where the
/// processor has them, which Eigen, compiled for every processor, can't. The same bytes on every
/// processor: no sum is taken in another order, no product rounded otherwise.
namespace waymark {

using MatrixView = Eigen::Ref<Eigen::MatrixXd>;
using ConstMatrixView = Eigen::Ref<const Eigen::MatrixXd>;

/// c += a b
void add_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c);

/// c += aᵀ b
void add_transposed_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c);

/// Of the symmetric positive definite matrix whose lower triangle is given the factor L (L Lᵀ) in
/// its place; what lies above is lost. False: it is none.
[[nodiscard]] bool factor_in_place(MatrixView matrix);

/// x ← L⁻¹ x, of the lower triangle of `lower`.
void solve_in_place(const ConstMatrixView& lower, MatrixView x);

/// x ← L⁻ᵀ x, of the same.
void solve_transposed_in_place(const ConstMatrixView& lower, MatrixView x);

}  // namespace waymark
