#pragma once

#include <Eigen/Core>

#include "mapbuilder/bundle/block_matrix.h"

namespace waymark::test {

/// The whole symmetric matrix.
inline Eigen::MatrixXd dense(const BlockMatrix& matrix) {
  const BlockPattern& pattern = matrix.pattern;
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(6 * pattern.columns(), 6 * pattern.columns());
  for (int c = 0; c < pattern.columns(); ++c) {
    for (int b = pattern.first[static_cast<std::size_t>(c)];
         b < pattern.first[static_cast<std::size_t>(c) + 1]; ++b) {
      const int r = pattern.rows[static_cast<std::size_t>(b)];
      full.block<6, 6>(6 * r, 6 * c) = matrix.blocks[static_cast<std::size_t>(b)];
      full.block<6, 6>(6 * c, 6 * r) = matrix.blocks[static_cast<std::size_t>(b)].transpose();
    }
  }
  return full;
}

}  // namespace waymark::test
