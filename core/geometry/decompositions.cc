#include "core/geometry/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace waymark {
namespace {

/// Without the QR decomposition that only other matrices than square ones need.
template <int N>
using SquareSvd = Eigen::JacobiSVD<Eigen::Matrix<double, N, N>, Eigen::NoQRPreconditioner>;

}  // namespace

template <int N>
SymmetricEigen<N> symmetric_eigen(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d&);
template SymmetricEigen<4> symmetric_eigen(const Eigen::Matrix4d&);
template SymmetricEigen<6> symmetric_eigen(const Matrix6d&);
template SymmetricEigen<Eigen::Dynamic> symmetric_eigen(const Eigen::MatrixXd&);

template <int N>
Eigen::Matrix<double, N, 1> symmetric_eigenvalues(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(symmetric,
                                                                          Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

template Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d&);
template Vector6d symmetric_eigenvalues(const Matrix6d&);

SingularVectors singular_vectors(const Eigen::Matrix3d& matrix) {
  const SquareSvd<3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.matrixV()};
}

double largest_singular_value(const Eigen::Matrix2d& matrix) {
  return SquareSvd<2>(matrix).singularValues()(0);
}

Matrix6d inverse(const Matrix6d& matrix) { return matrix.inverse(); }

Eigen::Quaterniond shortest_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

}  // namespace waymark
