#include "mapbuilder/bundle/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>

namespace waymark {
namespace {

using Index = std::size_t;

Index at(int i) { return static_cast<Index>(i); }

/// Position of each block in an order of little fill.
std::vector<int> fill_reducing_positions(const BlockPattern& pattern) {
  const int n = pattern.columns();
  if (n <= 0) return {};  // Eigen's ordering writes before the first of no columns
  std::vector<Eigen::Triplet<char>> entries;
  entries.reserve(2 * pattern.blocks());
  for (int c = 0; c < n; ++c) {
    for (int b = pattern.first[at(c)]; b < pattern.first[at(c) + 1]; ++b) {
      const int r = pattern.rows[at(b)];
      entries.emplace_back(r, c, 1);
      if (r != c) entries.emplace_back(c, r, 1);
    }
  }
  Eigen::SparseMatrix<char> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph, order);
  std::vector<int> position(at(n));
  // Eigen hands over the inverse permutation: order.indices()[k] is what comes k-th.
  for (int k = 0; k < n; ++k) position[at(order.indices()[k])] = k;
  return position;
}

}  // namespace

BlockCholesky::BlockCholesky(const BlockPattern& pattern)
    : columns_(pattern.columns()), position_(fill_reducing_positions(pattern)) {
  analyse(pattern);
}

void BlockCholesky::analyse(const BlockPattern& pattern) {
  const Index n = at(columns_);
  // Column patterns of the permuted lower half, then with fill: a column inherits what its children
  // in the elimination tree have below it.
  std::vector<std::vector<int>> below(n);
  for (int c = 0; c < columns_; ++c) {
    for (int b = pattern.first[at(c)] + 1; b < pattern.first[at(c) + 1]; ++b) {
      const int i = position_[at(pattern.rows[at(b)])];
      const int j = position_[at(c)];
      below[at(std::min(i, j))].push_back(std::max(i, j));
    }
  }
  std::vector<std::vector<int>> children(n);
  std::vector<int> seen_by(n, -1);
  std::vector<int> left_count(n, 0);
  for (int j = 0; j < columns_; ++j) {
    std::vector<int>& own = below[at(j)];
    seen_by[at(j)] = j;
    for (const int i : own) seen_by[at(i)] = j;
    for (const int child : children[at(j)]) {
      for (const int i : below[at(child)]) {
        if (seen_by[at(i)] == j) continue;
        seen_by[at(i)] = j;
        own.push_back(i);
      }
    }
    std::sort(own.begin(), own.end());
    if (!own.empty()) children[at(own.front())].push_back(j);
    first_.push_back(static_cast<int>(rows_.size()));
    rows_.insert(rows_.end(), own.begin(), own.end());
    for (const int i : own) ++left_count[at(i)];
  }
  first_.push_back(static_cast<int>(rows_.size()));

  left_first_.assign(n + 1, 0);
  std::partial_sum(left_count.begin(), left_count.end(), left_first_.begin() + 1);
  left_column_.resize(rows_.size());
  left_block_.resize(rows_.size());
  std::vector<int> next(left_first_.begin(), left_first_.end() - 1);
  for (int k = 0; k < columns_; ++k) {
    for (int b = first_[at(k)]; b < first_[at(k) + 1]; ++b) {
      const int slot = next[at(rows_[at(b)])]++;
      left_column_[at(slot)] = k;
      left_block_[at(slot)] = b;
    }
  }
}

bool BlockCholesky::factorize(const BlockMatrix& a) {
  below_.assign(rows_.size(), Matrix6d::Zero());
  diagonal_.assign(at(columns_), Matrix6d::Zero());
  diagonal_inverse_.resize(at(columns_));
  const auto place = [&](int row, int column) -> Matrix6d& {
    if (row == column) return diagonal_[at(column)];
    const auto begin = rows_.begin() + first_[at(column)];
    const auto end = rows_.begin() + first_[at(column) + 1];
    return below_[static_cast<Index>(std::lower_bound(begin, end, row) - rows_.begin())];
  };
  for (int c = 0; c < columns_; ++c) {
    for (int b = a.pattern.first[at(c)]; b < a.pattern.first[at(c) + 1]; ++b) {
      const int i = position_[at(a.pattern.rows[at(b)])];
      const int j = position_[at(c)];
      if (i >= j) {
        place(i, j) = a.blocks[at(b)];
      } else {
        place(j, i) = a.blocks[at(b)].transpose();
      }
    }
  }

  std::vector<int> block_of_row(at(columns_), -1);
  for (int j = 0; j < columns_; ++j) {
    for (int b = first_[at(j)]; b < first_[at(j) + 1]; ++b) block_of_row[at(rows_[at(b)])] = b;
    for (int l = left_first_[at(j)]; l < left_first_[at(j) + 1]; ++l) {
      const int k = left_column_[at(l)];
      const int b_jk = left_block_[at(l)];
      const Matrix6d l_jk_t = below_[at(b_jk)].transpose();
      diagonal_[at(j)].noalias() -= below_[at(b_jk)].lazyProduct(l_jk_t);
      for (int b = b_jk + 1; b < first_[at(k) + 1]; ++b) {
        below_[at(block_of_row[at(rows_[at(b)])])].noalias() -= below_[at(b)].lazyProduct(l_jk_t);
      }
    }
    const Eigen::LLT<Matrix6d> llt(diagonal_[at(j)]);
    if (llt.info() != Eigen::Success) return false;
    diagonal_[at(j)] = llt.matrixL();
    if (!(diagonal_[at(j)].diagonal().array() > 0).all()) return false;
    Matrix6d& inverse = diagonal_inverse_[at(j)];
    inverse.setIdentity();
    diagonal_[at(j)].triangularView<Eigen::Lower>().solveInPlace(inverse);
    const Matrix6d inverse_t = inverse.transpose();
    for (int b = first_[at(j)]; b < first_[at(j) + 1]; ++b) {
      below_[at(b)] = below_[at(b)].lazyProduct(inverse_t).eval();
    }
  }
  return true;
}

Eigen::MatrixXd BlockCholesky::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x(b.rows(), b.cols());
  for (int c = 0; c < columns_; ++c)
    x.middleRows<6>(6L * position_[at(c)]) = b.middleRows<6>(6L * c);
  for (int j = 0; j < columns_; ++j) {
    const Eigen::Matrix<double, 6, Eigen::Dynamic> x_j =
        diagonal_inverse_[at(j)] * x.middleRows<6>(6L * j);
    x.middleRows<6>(6L * j) = x_j;
    for (int k = first_[at(j)]; k < first_[at(j) + 1]; ++k) {
      x.middleRows<6>(6L * rows_[at(k)]).noalias() -= below_[at(k)] * x_j;
    }
  }
  for (int j = columns_ - 1; j >= 0; --j) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> x_j = x.middleRows<6>(6L * j);
    for (int k = first_[at(j)]; k < first_[at(j) + 1]; ++k) {
      x_j.noalias() -= below_[at(k)].transpose() * x.middleRows<6>(6L * rows_[at(k)]);
    }
    x.middleRows<6>(6L * j).noalias() = diagonal_inverse_[at(j)].transpose() * x_j;
  }
  Eigen::MatrixXd result(b.rows(), b.cols());
  for (int c = 0; c < columns_; ++c) {
    result.middleRows<6>(6L * c) = x.middleRows<6>(6L * position_[at(c)]);
  }
  return result;
}

std::vector<Matrix6d> BlockCholesky::inverse_diagonal() const {
  // Z = A⁻¹ solves Z L = L⁻ᵀ: with P the rows of column j below the diagonal,
  // Z_Pj = −Z_PP L_Pj L_jj⁻¹ and Z_jj = (L_jj⁻ᵀ − Z_Pjᵀ L_Pj) L_jj⁻¹. Z_PP lies on the pattern.
  std::vector<Matrix6d> below(rows_.size());
  std::vector<Matrix6d> diagonal(at(columns_));
  std::vector<int> place(at(columns_), -1);
  std::vector<Matrix6d> z;
  for (int j = columns_ - 1; j >= 0; --j) {
    const int begin = first_[at(j)];
    const int size = first_[at(j) + 1] - begin;
    z.assign(at(size), Matrix6d::Zero());
    for (int p = 0; p < size; ++p) place[at(rows_[at(begin + p)])] = p;
    for (int p = 0; p < size; ++p) {
      const int k = rows_[at(begin + p)];
      const Matrix6d& l_kj = below_[at(begin + p)];
      z[at(p)].noalias() += diagonal[at(k)].lazyProduct(l_kj);
      for (int q = first_[at(k)]; q < first_[at(k) + 1]; ++q) {
        const int i = place[at(rows_[at(q)])];
        if (i < 0) continue;
        const Matrix6d& z_ik = below[at(q)];
        z[at(i)].noalias() += z_ik.lazyProduct(l_kj);
        z[at(p)].noalias() += z_ik.transpose().lazyProduct(below_[at(begin + i)]);
      }
    }
    const Matrix6d& inverse = diagonal_inverse_[at(j)];
    Matrix6d z_jj = inverse.transpose();
    for (int p = 0; p < size; ++p) {
      Matrix6d& z_pj = below[at(begin + p)];
      z_pj.noalias() = -(z[at(p)] * inverse);
      z_jj.noalias() -= z_pj.transpose() * below_[at(begin + p)];
      place[at(rows_[at(begin + p)])] = -1;
    }
    const Matrix6d full = z_jj * inverse;
    diagonal[at(j)] = 0.5 * (full + full.transpose());
  }
  std::vector<Matrix6d> result(at(columns_));
  for (int c = 0; c < columns_; ++c) result[at(c)] = diagonal[at(position_[at(c)])];
  return result;
}

}  // namespace waymark
