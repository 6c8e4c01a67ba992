#include "core/geometry/symmetric_factor.h"

namespace waymark {

template <int N>
SymmetricFactor<N>::SymmetricFactor(const Matrix& symmetric) : factor_(symmetric) {}

template <int N>
typename SymmetricFactor<N>::Vector SymmetricFactor<N>::solve(const Vector& right) const {
  return factor_.solve(right);
}

template <int N>
typename SymmetricFactor<N>::Matrix SymmetricFactor<N>::solve_columns(const Matrix& right) const {
  return factor_.solve(right);
}

template <int N>
typename SymmetricFactor<N>::Matrix SymmetricFactor<N>::inverse() const {
  return solve_columns(Matrix::Identity());
}

template class SymmetricFactor<3>;
template class SymmetricFactor<6>;
template class SymmetricFactor<7>;
template class SymmetricFactor<8>;
template class SymmetricFactor<12>;
template class SymmetricFactor<21>;
template SymmetricFactor<9>::SymmetricFactor(const Matrix&);
template SymmetricFactor<9>::Vector SymmetricFactor<9>::solve(const Vector&) const;

}  // namespace waymark
