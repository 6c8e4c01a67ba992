#include "mapbuilder/upkeep/marker_system.h"

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

constexpr double kLeastSigma = 1e-5;   // m and rad
constexpr double kUnknownSigma = 0.1;  // m and rad

Matrix6d information_of(const Matrix6d& covariance) {
  if (!covariance.allFinite()) return Matrix6d::Identity() / (kUnknownSigma * kUnknownSigma);
  const SymmetricEigen<6> eigen = symmetric_eigen<6>(covariance);
  const Vector6d variances = eigen.values.cwiseMax(kLeastSigma * kLeastSigma);
  return eigen.vectors * variances.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
}

/// Takes a marker out of the others' blocks, and its own away.
void eliminate(MarkerSystem& system, int marker) {
  const SymmetricEigen<6> own = symmetric_eigen<6>(system.blocks.at({marker, marker}));
  const bool determined = own.values[0] > 1e-12 * own.values[5];
  const Matrix6d inverse_own =
      own.vectors * own.values.cwiseInverse().asDiagonal() * own.vectors.transpose();
  // N_im of each neighbour i.
  std::vector<std::pair<int, Matrix6d>> neighbours;
  for (auto at = system.blocks.begin(); at != system.blocks.end();) {
    const auto [row, column] = at->first;
    if ((row == marker) == (column == marker)) {
      ++at;
      continue;
    }
    const Matrix6d block = at->second;
    neighbours.emplace_back(row == marker ? column : row,
                            row == marker ? Matrix6d(block.transpose()) : block);
    at = system.blocks.erase(at);
  }
  system.blocks.erase({marker, marker});
  if (!determined) return;
  for (const auto& [i, by_marker] : neighbours) {
    for (const auto& [j, other] : neighbours) {
      if (j > i) continue;
      auto& block = system.blocks.try_emplace({i, j}, Matrix6d::Zero()).first->second;
      block -= by_marker * inverse_own * other.transpose();
    }
  }
}

}  // namespace

BlockMatrix block_matrix_of(const MarkerSystem& system) {
  BlockMatrix matrix;
  std::vector<std::vector<std::pair<int, const Matrix6d*>>> columns(
      static_cast<std::size_t>(system.markers()));
  for (const auto& [at, block] : system.blocks) {
    columns[static_cast<std::size_t>(at.second)].emplace_back(at.first, &block);
  }
  for (const auto& column : columns) {
    matrix.pattern.first.push_back(static_cast<int>(matrix.blocks.size()));
    for (const auto& [row, block] : column) {
      matrix.pattern.rows.push_back(row);
      matrix.blocks.push_back(*block);
    }
  }
  matrix.pattern.first.push_back(static_cast<int>(matrix.blocks.size()));
  return matrix;
}

MarkerSystem independent_system(const SubMap& submap) {
  MarkerSystem system;
  system.world_is_fixed = true;
  for (const MapMarker& marker : submap.markers) {
    const int i = system.markers();
    system.blocks[{i, i}] = information_of(marker.covariance);
    system.world_from_marker.push_back(marker.world_from_marker);
  }
  return system;
}

MarkerSystem marginal_system(MarkerSystem system, const std::vector<int>& kept) {
  std::vector<int> slot(static_cast<std::size_t>(system.markers()), -1);
  MarkerSystem result;
  result.world_is_fixed = system.world_is_fixed;
  for (const int marker : kept) {
    slot[static_cast<std::size_t>(marker)] = result.markers();
    result.world_from_marker.push_back(system.world_from_marker[static_cast<std::size_t>(marker)]);
  }
  for (int marker = 0; marker < system.markers(); ++marker) {
    if (slot[static_cast<std::size_t>(marker)] < 0) eliminate(system, marker);
  }
  for (const auto& [at, block] : system.blocks) {
    const int row = slot[static_cast<std::size_t>(at.first)];
    const int column = slot[static_cast<std::size_t>(at.second)];
    if (row >= 0 && column >= 0) result.blocks[{row, column}] = block;
  }
  return result;
}

}  // namespace waymark
