#include "mapbuilder/mapping/selected_inverse.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <vector>

namespace waymark {

std::optional<SelectedInverse> SelectedInverse::compute(const Eigen::SparseMatrix<double>& a) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(a);
  if (ldlt.info() != Eigen::Success) return std::nullopt;
  SelectedInverse result;
  result.pivots_ = ldlt.vectorD();
  if (!(result.pivots_.array() > 0).all()) return std::nullopt;
  result.factor_ = ldlt.matrixL().nestedExpression().triangularView<Eigen::StrictlyLower>();
  result.factor_.makeCompressed();
  result.permuted_from_original_ = ldlt.permutationP();

  // Z = A⁻¹ from the last column back: with P the pattern of L's column j below the diagonal,
  // Z_Pj = −Z_PP L_Pj and Z_jj = 1/D_j − L_Pjᵀ Z_Pj. Z_PP lies on the pattern already known.
  const int n = static_cast<int>(a.rows());
  const int* start = result.factor_.outerIndexPtr();
  const int* rows = result.factor_.innerIndexPtr();
  const double* l = result.factor_.valuePtr();
  const auto count = static_cast<std::size_t>(result.factor_.nonZeros());
  std::vector<double> below(count, 0.0);
  std::vector<double> diagonal(static_cast<std::size_t>(n), 0.0);
  std::vector<int> place(static_cast<std::size_t>(n), -1);
  std::vector<double> z;
  for (int j = n - 1; j >= 0; --j) {
    const int first = start[j];
    const int size = start[j + 1] - first;
    z.assign(static_cast<std::size_t>(size), 0.0);
    for (int p = 0; p < size; ++p) place[static_cast<std::size_t>(rows[first + p])] = p;
    for (int p = 0; p < size; ++p) {
      const int k = rows[first + p];
      const double l_kj = l[first + p];
      z[static_cast<std::size_t>(p)] += diagonal[static_cast<std::size_t>(k)] * l_kj;
      for (int q = start[k]; q < start[k + 1]; ++q) {
        const int at = place[static_cast<std::size_t>(rows[q])];
        if (at < 0) continue;
        const double z_ik = below[static_cast<std::size_t>(q)];
        z[static_cast<std::size_t>(at)] += z_ik * l_kj;
        z[static_cast<std::size_t>(p)] += z_ik * l[first + at];
      }
    }
    double z_jj = 1.0 / result.pivots_[j];
    for (int p = 0; p < size; ++p) {
      below[static_cast<std::size_t>(first + p)] = -z[static_cast<std::size_t>(p)];
      z_jj += l[first + p] * z[static_cast<std::size_t>(p)];
      place[static_cast<std::size_t>(rows[first + p])] = -1;
    }
    diagonal[static_cast<std::size_t>(j)] = z_jj;
  }

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(count + static_cast<std::size_t>(n));
  for (int j = 0; j < n; ++j) {
    entries.emplace_back(j, j, diagonal[static_cast<std::size_t>(j)]);
    for (int p = start[j]; p < start[j + 1]; ++p) {
      entries.emplace_back(rows[p], j, below[static_cast<std::size_t>(p)]);
    }
  }
  result.inverse_.resize(n, n);
  result.inverse_.setFromTriplets(entries.begin(), entries.end());
  return result;
}

double SelectedInverse::operator()(int row, int column) const {
  const int i = permuted_from_original_.indices()[row];
  const int j = permuted_from_original_.indices()[column];
  return inverse_.coeff(std::max(i, j), std::min(i, j));
}

Eigen::MatrixXd SelectedInverse::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x = permuted_from_original_ * b;
  factor_.triangularView<Eigen::UnitLower>().solveInPlace(x);
  x = pivots_.cwiseInverse().asDiagonal() * x;
  factor_.transpose().triangularView<Eigen::UnitUpper>().solveInPlace(x);
  return permuted_from_original_.transpose() * x;
}

}  // namespace waymark
