#include "core/geometry/dense_products.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

using Eigen::Index;

constexpr Index kWidth = 4;
using Lanes [[gnu::vector_size(kWidth * sizeof(double))]] = double;
/// The same in a matrix, at any address.
using LanesInMemory
    [[gnu::vector_size(kWidth * sizeof(double)), gnu::aligned(sizeof(double)), gnu::may_alias]] =
        double;

const LanesInMemory& lanes_at(const double* place) {
  return *reinterpret_cast<const LanesInMemory*>(place);
}
LanesInMemory& lanes_at(double* place) { return *reinterpret_cast<LanesInMemory*>(place); }

/// A matrix as a product reads it: transposed or not, one stride is 1.
struct Operand {
  const double* data;
  Index by_row, by_column;  ///< from one element to the next
};

Operand plain(const ConstMatrixView& m) { return {m.data(), 1, m.outerStride()}; }
Operand transposed(const ConstMatrixView& m) { return {m.data(), m.outerStride(), 1}; }

/// A tile of c += sign · a b, kVectors · kWidth rows high; a's rows lie side by side.
template <int kVectors, int kColumns>
[[gnu::always_inline]] inline void add_tile(const double* a, Index a_stride, const double* b,
                                            const Operand& of_b, Index depth, double sign,
                                            double* c, Index c_stride) {
  Lanes sums[kColumns][kVectors] = {};
  for (Index k = 0; k < depth; ++k, a += a_stride, b += of_b.by_row) {
#pragma GCC unroll 4
    for (int j = 0; j < kColumns; ++j) {
      const double right = b[j * of_b.by_column];
#pragma GCC unroll 2
      for (int v = 0; v < kVectors; ++v) sums[j][v] += lanes_at(a + v * kWidth) * right;
    }
  }
#pragma GCC unroll 4
  for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 2
    for (int v = 0; v < kVectors; ++v) lanes_at(c + j * c_stride + v * kWidth) += sign * sums[j][v];
  }
}

/// The same for what no tile covers.
[[gnu::always_inline]] inline void add_element(const double* a, Index a_stride, const double* b,
                                               Index b_stride, Index depth, double sign,
                                               double* c) {
  double sum = 0;
  for (Index k = 0; k < depth; ++k) sum += a[k * a_stride] * b[k * b_stride];
  *c += sign * sum;
}

/// kColumns columns of c += sign · a b.
template <int kColumns>
[[gnu::always_inline]] inline void add_columns(const Operand& a, const double* b,
                                               const Operand& of_b, Index rows, Index depth,
                                               double sign, double* c, Index c_stride) {
  Index i = 0;
  for (; i + 2 * kWidth <= rows; i += 2 * kWidth) {
    add_tile<2, kColumns>(a.data + i, a.by_column, b, of_b, depth, sign, c + i, c_stride);
  }
  for (; i + kWidth <= rows; i += kWidth) {
    add_tile<1, kColumns>(a.data + i, a.by_column, b, of_b, depth, sign, c + i, c_stride);
  }
  for (; i < rows; ++i) {
    for (int j = 0; j < kColumns; ++j) {
      add_element(a.data + i, a.by_column, b + j * of_b.by_column, of_b.by_row, depth, sign,
                  c + i + j * c_stride);
    }
  }
}

/// c += sign · a b; a's rows lie side by side.
struct Add {
  Operand a, b;
  Index depth;
  double sign;
  double* c;
  Index rows, columns, c_stride;

  [[gnu::always_inline]] inline void operator()() const {
    Index j = 0;
    for (; j + 4 <= columns; j += 4) {
      add_columns<4>(a, b.data + j * b.by_column, b, rows, depth, sign, c + j * c_stride, c_stride);
    }
    for (; j < columns; ++j) {
      add_columns<1>(a, b.data + j * b.by_column, b, rows, depth, sign, c + j * c_stride, c_stride);
    }
  }
};

/// c += sign · aᵀ b: every element is the product of two columns.
struct AddTransposed {
  Operand a, b;
  Index depth;
  double sign;
  double* c;
  Index rows, columns, c_stride;

  [[gnu::always_inline]] inline void operator()() const {
    constexpr Index kSide = 3;
    for (Index j = 0; j < columns; j += kSide) {
      for (Index i = 0; i < rows; i += kSide) {
        if (i + kSide <= rows && j + kSide <= columns) {
          tile<kSide>(i, j);
          continue;
        }
        for (Index jj = j; jj < std::min(j + kSide, columns); ++jj) {
          for (Index ii = i; ii < std::min(i + kSide, rows); ++ii) tile<1>(ii, jj);
        }
      }
    }
  }

  template <int kSide>
  [[gnu::always_inline]] inline void tile(Index i, Index j) const {
    Lanes sums[kSide][kSide] = {};
    const double* left = a.data + i * a.by_column;
    const double* right = b.data + j * b.by_column;
    Index k = 0;
    for (; k + kWidth <= depth; k += kWidth) {
#pragma GCC unroll 3
      for (int t = 0; t < kSide; ++t) {
        const Lanes of_b = lanes_at(right + t * b.by_column + k);
#pragma GCC unroll 3
        for (int s = 0; s < kSide; ++s) sums[t][s] += lanes_at(left + s * a.by_column + k) * of_b;
      }
    }
#pragma GCC unroll 3
    for (int t = 0; t < kSide; ++t) {
#pragma GCC unroll 3
      for (int s = 0; s < kSide; ++s) {
        double sum = sums[t][s][0] + sums[t][s][1] + sums[t][s][2] + sums[t][s][3];
        for (Index rest = k; rest < depth; ++rest) {
          sum += left[s * a.by_column + rest] * right[t * b.by_column + rest];
        }
        c[i + s + (j + t) * c_stride] += sign * sum;
      }
    }
  }
};

#if defined(__x86_64__)
template <typename Work>
[[gnu::target("avx2")]] void work_wide(const Work& work) {
  work();
}
bool has_wide() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#else
template <typename Work>
void work_wide(const Work& work) {
  work();
}
bool has_wide() { return false; }
#endif

/// With the widest vectors of this processor.
template <typename Work>
void work_on(const Work& work) {
  if (has_wide()) {
    work_wide(work);
  } else {
    work();
  }
}

void add(const Operand& a, const Operand& b, Index depth, double sign, MatrixView c) {
  work_on(Add{a, b, depth, sign, c.data(), c.rows(), c.cols(), c.outerStride()});
}

void add_by_columns(const ConstMatrixView& a, const ConstMatrixView& b, double sign, MatrixView c) {
  work_on(AddTransposed{plain(a), plain(b), a.rows(), sign, c.data(), c.rows(), c.cols(),
                        c.outerStride()});
}

/// Smaller ones are done element by element.
constexpr Index kFew = 8;

/// The first of two halves, of whole vectors.
Index first_half(Index size) { return (size / 2 + kWidth - 1) / kWidth * kWidth; }

bool factor_few(MatrixView m) {
  for (Index j = 0; j < m.cols(); ++j) {
    const double pivot = m(j, j) - m.row(j).head(j).squaredNorm();
    if (!(pivot > 0)) return false;
    m(j, j) = std::sqrt(pivot);
    for (Index i = j + 1; i < m.rows(); ++i) {
      m(i, j) = (m(i, j) - m.row(i).head(j).dot(m.row(j).head(j))) / m(j, j);
    }
  }
  return true;
}

void solve_few(const ConstMatrixView& lower, MatrixView x) {
  for (Index column = 0; column < x.cols(); ++column) {
    for (Index i = 0; i < lower.rows(); ++i) {
      const double sum = lower.row(i).head(i).dot(x.col(column).head(i));
      x(i, column) = (x(i, column) - sum) / lower(i, i);
    }
  }
}

void solve_transposed_few(const ConstMatrixView& lower, MatrixView x) {
  for (Index column = 0; column < x.cols(); ++column) {
    for (Index i = lower.rows(); i-- > 0;) {
      const Index after = lower.rows() - i - 1;
      const double sum = lower.col(i).tail(after).dot(x.col(column).tail(after));
      x(i, column) = (x(i, column) - sum) / lower(i, i);
    }
  }
}

/// x ← x L⁻ᵀ
void solve_on_the_right(const ConstMatrixView& lower, MatrixView x) {
  const Index size = lower.rows();
  if (size <= kFew) {
    for (Index j = 0; j < size; ++j) {
      for (Index k = 0; k < j; ++k) x.col(j) -= lower(j, k) * x.col(k);
      x.col(j) /= lower(j, j);
    }
    return;
  }
  const Index half = first_half(size);
  const auto first = x.leftCols(half);
  const auto below = lower.block(half, 0, size - half, half);
  solve_on_the_right(lower.topLeftCorner(half, half), first);
  add(plain(first), transposed(below), half, -1, x.rightCols(size - half));
  solve_on_the_right(lower.bottomRightCorner(size - half, size - half), x.rightCols(size - half));
}

/// The lower triangle of m −= a aᵀ, and a little more.
void subtract_square(const ConstMatrixView& a, MatrixView m) {
  constexpr Index kColumns = 16;
  for (Index j = 0; j < m.cols(); j += kColumns) {
    const Index columns = std::min(kColumns, m.cols() - j);
    add(plain(a.bottomRows(a.rows() - j)), transposed(a.middleRows(j, columns)), a.cols(), -1,
        m.block(j, j, m.rows() - j, columns));
  }
}

}  // namespace

void add_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c) {
  add(plain(a), plain(b), a.cols(), 1, c);
}

void add_transposed_product(const ConstMatrixView& a, const ConstMatrixView& b, MatrixView c) {
  add_by_columns(a, b, 1, c);
}

// By halves: what is left between them is a product, which is where the time goes.

bool factor_in_place(MatrixView matrix) {
  const Index size = matrix.rows();
  if (size <= kFew) return factor_few(matrix);
  const Index half = first_half(size);
  auto first = matrix.topLeftCorner(half, half);
  auto below = matrix.bottomLeftCorner(size - half, half);
  auto second = matrix.bottomRightCorner(size - half, size - half);
  if (!factor_in_place(first)) return false;
  solve_on_the_right(first, below);
  subtract_square(below, second);
  return factor_in_place(second);
}

void solve_in_place(const ConstMatrixView& lower, MatrixView x) {
  const Index size = lower.rows();
  if (size <= kFew) {
    solve_few(lower, x);
    return;
  }
  const Index half = first_half(size);
  solve_in_place(lower.topLeftCorner(half, half), x.topRows(half));
  add(plain(lower.bottomLeftCorner(size - half, half)), plain(x.topRows(half)), half, -1,
      x.bottomRows(size - half));
  solve_in_place(lower.bottomRightCorner(size - half, size - half), x.bottomRows(size - half));
}

void solve_transposed_in_place(const ConstMatrixView& lower, MatrixView x) {
  const Index size = lower.rows();
  if (size <= kFew) {
    solve_transposed_few(lower, x);
    return;
  }
  const Index half = first_half(size);
  solve_transposed_in_place(lower.bottomRightCorner(size - half, size - half),
                            x.bottomRows(size - half));
  add_by_columns(lower.bottomLeftCorner(size - half, half), x.bottomRows(size - half), -1,
                 x.topRows(half));
  solve_transposed_in_place(lower.topLeftCorner(half, half), x.topRows(half));
}

}  // namespace waymark
