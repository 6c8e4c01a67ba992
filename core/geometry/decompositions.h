#pragma once

#include <Eigen/Core>

#include "core/geometry/rigid3.h"

/// Eigen's eigenvectors, singular values and inverses of the sizes that are used, compiled once: in
/// every file that uses them they would take seconds of a build. Algorithms and results are
/// Eigen's.
namespace waymark {

/// Eigenvalues in ascending order, eigenvectors as columns.
template <int N>
struct SymmetricEigen {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};

/// Of a symmetric matrix; its lower triangle is read. N is 3, 4, 6 or Eigen::Dynamic.
template <int N>
[[nodiscard]] SymmetricEigen<N> symmetric_eigen(const Eigen::Matrix<double, N, N>& symmetric);

/// Eigenvalues alone, in ascending order. N is 3 or 6.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, 1> symmetric_eigenvalues(
    const Eigen::Matrix<double, N, N>& symmetric);

/// U and V of U·S·Vᵀ, singular values in descending order.
struct SingularVectors {
  Eigen::Matrix3d u;
  Eigen::Matrix3d v;
};
[[nodiscard]] SingularVectors singular_vectors(const Eigen::Matrix3d& matrix);

[[nodiscard]] double largest_singular_value(const Eigen::Matrix2d& matrix);

[[nodiscard]] Matrix6d inverse(const Matrix6d& matrix);

/// Turns `from` into `to` (of any length but zero) the short way; opposite ones about any axis.
[[nodiscard]] Eigen::Quaterniond shortest_rotation(const Eigen::Vector3d& from,
                                                   const Eigen::Vector3d& to);

}  // namespace waymark
