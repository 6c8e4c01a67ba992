#include "mapbuilder/bundle/marker_covariances.h"

#include <Eigen/Dense>
#include <algorithm>

#include "core/geometry/alignment.h"
#include "core/geometry/decompositions.h"
#include "mapbuilder/bundle/block_cholesky.h"

namespace waymark {
namespace {

/// The motions of the world frame as the markers feel them, about `centre`: 6 columns (shift,
/// turn).
Eigen::MatrixXd world_motions(const std::vector<Rigid3>& markers, const Eigen::Vector3d& centre) {
  Eigen::MatrixXd n = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * markers.size()), 6);
  for (std::size_t i = 0; i < markers.size(); ++i) {
    auto rows = n.middleRows<6>(static_cast<Eigen::Index>(6 * i));
    rows.topLeftCorner<3, 3>().setIdentity();
    rows.topRightCorner<3, 3>() = -skew(markers[i].translation - centre);
    rows.bottomRightCorner<3, 3>().setIdentity();
  }
  return n;
}

/// The marker whose place is known best: the one with the largest information about it.
int best_known(const BlockMatrix& information, int markers) {
  int best = 0;
  double most = -1;
  for (int i = 0; i < markers; ++i) {
    const int diagonal = information.pattern.first[static_cast<std::size_t>(i)];
    const double trace =
        information.blocks[static_cast<std::size_t>(diagonal)].diagonal().head<3>().sum();
    if (trace > most) {
      most = trace;
      best = i;
    }
  }
  return best;
}

}  // namespace

MarkerInformation marker_information(const BundleProblem& problem, const Estimate& estimate,
                                     int threads) {
  const Observations& all = problem.prepared->observations();
  std::vector<ObservationIndex> used;
  for (const ObservationIndex index : problem.observations) {
    if (estimate.accepts(index) && estimate.posed(all[index])) used.push_back(index);
  }
  ReducedProblem reduced(problem, used, {}, estimate, threads);
  MarkerInformation result;
  result.information = reduced.reduce(reduced.start(), 0.0).information;
  result.markers = reduced.markers();
  result.world_is_fixed =
      !result.markers.empty() && problem.scope.in_facility(result.markers.front());
  result.world_from_marker = reduced.start().world_from_marker;
  return result;
}

std::vector<Matrix6d> marker_covariances(const MarkerInformation& information) {
  const auto count = static_cast<int>(information.markers.size());
  if (count < 2) return {};
  const std::vector<Rigid3>& poses = information.world_from_marker;
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : poses) {
    positions.push_back(pose.translation);
    centre += pose.translation / count;
  }
  if (information.world_is_fixed) {
    BlockCholesky cholesky(information.information.pattern);
    if (!cholesky.factorize(information.information)) return {};
    std::vector<Matrix6d> covariances = cholesky.inverse_diagonal();
    covariances.resize(information.markers.size());
    return covariances;
  }
  const int anchor = best_known(information.information, count);
  BlockMatrix fixed = information.information;
  fix_block(fixed, anchor);
  BlockCholesky cholesky(fixed.pattern);
  if (!cholesky.factorize(fixed)) return {};
  const std::vector<Matrix6d> own_blocks = cholesky.inverse_diagonal();

  const Eigen::MatrixXd n = world_motions(poses, centre);
  Eigen::MatrixXd g = n;
  if (count >= 3 && !lie_on_a_line(positions)) {
    for (int i = 0; i < count; ++i) g.middleRows<3>(6 * i + 3).setZero();
  }
  const Matrix6d gauge = inverse(g.transpose() * n);
  // S⁻ G, with zero rows for the fixed marker.
  // Calibration has no part in the world's motion.
  Eigen::MatrixXd g_free = Eigen::MatrixXd::Zero(6 * fixed.pattern.columns(), 6);
  g_free.topRows(6 * count) = g;
  g_free.middleRows<6>(6 * anchor).setZero();
  const Eigen::MatrixXd cg = cholesky.solve(g_free).topRows(6 * count);
  const Matrix6d gcg = g.transpose() * cg;

  std::vector<Matrix6d> covariances;
  for (int i = 0; i < count; ++i) {
    Matrix6d own = Matrix6d::Zero();
    if (i != anchor) own = own_blocks[static_cast<std::size_t>(i)];
    const Matrix6d moved = n.middleRows<6>(6 * i) * gauge;
    const Matrix6d cross = moved * cg.middleRows<6>(6 * i).transpose();
    const Matrix6d full = own - cross - cross.transpose() + moved * gcg * moved.transpose();
    // A difference of large numbers: rounding may leave an eigenvalue a little below zero.
    const SymmetricEigen<6> eigen = symmetric_eigen<6>(0.5 * (full + full.transpose()));
    const Matrix6d root = eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
    covariances.emplace_back(root * root.transpose());
  }
  return covariances;
}

}  // namespace waymark
