#include "core/geometry/sliced_products.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace waymark {
namespace {

/// Calls `use(first, count)` for slices of `size`, each so thin that `rows` of it fit Eigen's
/// workspace.
template <typename Use>
void for_each_slice(Eigen::Index size, Eigen::Index rows, const Use& use) {
  constexpr Eigen::Index kFits = EIGEN_STACK_ALLOCATION_LIMIT / sizeof(double);
  const Eigen::Index slice =
      std::clamp<Eigen::Index>(kFits / std::max<Eigen::Index>(rows, 1), 8, 64);
  for (Eigen::Index k = 0; k < size; k += slice) use(k, std::min(slice, size - k));
}

}  // namespace

void add_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c) {
  for_each_slice(a.cols(), std::max(a.rows(), b.cols()), [&](Eigen::Index k, Eigen::Index count) {
    c.noalias() += a.middleCols(k, count) * b.middleRows(k, count);
  });
}

void add_transposed_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c) {
  for_each_slice(a.rows(), std::max(a.cols(), b.cols()), [&](Eigen::Index k, Eigen::Index count) {
    c.noalias() += a.middleRows(k, count).transpose() * b.middleRows(k, count);
  });
}

bool factor_in_place(MatrixView matrix) {
  bool positive = true;
  for_each_slice(matrix.rows(), matrix.rows(), [&](Eigen::Index k, Eigen::Index count) {
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
  for_each_slice(
      lower.rows(), std::max(lower.rows(), x.cols()), [&](Eigen::Index k, Eigen::Index count) {
        auto solved = x.middleRows(k, count);
        lower.block(k, k, count, count).triangularView<Eigen::Lower>().solveInPlace(solved);
        const Eigen::Index rest = lower.rows() - k - count;
        x.bottomRows(rest).noalias() -= lower.block(k + count, k, rest, count) * solved;
      });
}

}  // namespace waymark
