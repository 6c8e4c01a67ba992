#include "core/geometry/sliced_products.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace waymark {
namespace {

constexpr Eigen::Index kSlice = 32;

/// Calls `use(first, count)` for each slice of `size` rows.
template <typename Use>
void for_each_slice(Eigen::Index size, const Use& use) {
  for (Eigen::Index k = 0; k < size; k += kSlice) use(k, std::min(kSlice, size - k));
}

}  // namespace

void add_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c) {
  for_each_slice(a.cols(), [&](Eigen::Index k, Eigen::Index count) {
    c.noalias() += a.middleCols(k, count) * b.middleRows(k, count);
  });
}

void add_transposed_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c) {
  for_each_slice(a.rows(), [&](Eigen::Index k, Eigen::Index count) {
    c.noalias() += a.middleRows(k, count).transpose() * b.middleRows(k, count);
  });
}

bool factor_in_place(MatrixView matrix) {
  bool positive = true;
  for_each_slice(matrix.rows(), [&](Eigen::Index k, Eigen::Index count) {
    auto own = matrix.block(k, k, count, count);
    const Eigen::LLT<MatrixView> factor(own);
    positive = positive && factor.info() == Eigen::Success;
    const Eigen::Index rest = matrix.rows() - k - count;
    auto below = matrix.block(k + count, k, rest, count);
    own.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
    matrix.bottomRightCorner(rest, rest).triangularView<Eigen::Lower>() -=
        below * below.transpose();
  });
  return positive;
}

void solve_in_place(const ConstMatrixView& lower, MatrixView x) {
  for_each_slice(lower.rows(), [&](Eigen::Index k, Eigen::Index count) {
    auto solved = x.middleRows(k, count);
    lower.block(k, k, count, count).triangularView<Eigen::Lower>().solveInPlace(solved);
    const Eigen::Index rest = lower.rows() - k - count;
    x.bottomRows(rest).noalias() -= lower.block(k + count, k, rest, count) * solved;
  });
}

}  // namespace waymark
