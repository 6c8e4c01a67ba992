#include "mapbuilder/bundle/marker_covariances.h"

#include <Eigen/Dense>
#include <algorithm>

#include "core/geometry/alignment.h"
#include "core/geometry/decompositions.h"

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

std::vector<ObservationIndex> accepted_observations(const BundleProblem& problem,
                                                    const Estimate& estimate) {
  const Observations& all = problem.prepared->observations();
  std::vector<ObservationIndex> accepted;
  for (const ObservationIndex index : problem.observations) {
    if (estimate.accepts(index) && estimate.posed(all[index])) accepted.push_back(index);
  }
  return accepted;
}

MarkerInformation marker_information(const BundleProblem& problem, const Estimate& estimate,
                                     int threads) {
  ReducedProblem reduced(problem, accepted_observations(problem, estimate), {}, estimate, threads);
  MarkerInformation result;
  result.information = reduced.reduce(reduced.start(), 0.0).information;
  result.markers = reduced.markers();
  result.world_is_fixed =
      !result.markers.empty() && problem.scope.in_facility(result.markers.front());
  result.world_from_marker = reduced.start().world_from_marker;
  return result;
}

std::optional<MarkerInverse> MarkerInverse::of(const MarkerInformation& information) {
  const auto count = static_cast<int>(information.markers.size());
  if (count < 2) return std::nullopt;
  const int anchor = information.world_is_fixed ? -1 : best_known(information.information, count);
  MarkerInverse inverse(information, anchor);
  if (!inverse.factorize(information)) return std::nullopt;
  return inverse;
}

MarkerInverse::MarkerInverse(const MarkerInformation& information, int anchor)
    : count_(static_cast<int>(information.markers.size())),
      anchor_(anchor),
      cholesky_(information.information.pattern) {
  if (anchor < 0) return;
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : information.world_from_marker) {
    positions.push_back(pose.translation);
    centre += pose.translation / count_;
  }
  motions_ = world_motions(information.world_from_marker, centre);
  gauge_ = motions_;
  if (count_ >= 3 && !lie_on_a_line(positions)) {
    for (int i = 0; i < count_; ++i) gauge_.middleRows<3>(6 * i + 3).setZero();
  }
  gauge_inverse_ = inverse(gauge_.transpose() * motions_);
}

bool MarkerInverse::factorize(const MarkerInformation& information) {
  if (anchor_ < 0) return cholesky_.factorize(information.information);
  BlockMatrix fixed = information.information;
  fix_block(fixed, anchor_);
  return cholesky_.factorize(fixed);
}

Eigen::MatrixXd MarkerInverse::solve_free(Eigen::MatrixXd b) const {
  if (anchor_ >= 0) b.middleRows<6>(6 * anchor_).setZero();
  // Calibration has no part in what is asked.
  const Eigen::Index rows = b.rows();
  b.conservativeResize(6L * cholesky_.columns(), Eigen::NoChange);
  b.bottomRows(b.rows() - rows).setZero();
  return cholesky_.solve(b).topRows(rows);
}

Eigen::MatrixXd MarkerInverse::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x = solve_free(b);
  if (anchor_ >= 0) x -= motions_ * (gauge_inverse_ * (gauge_.transpose() * x)).eval();
  return x;
}

Eigen::MatrixXd MarkerInverse::covariance_times(const Eigen::MatrixXd& x) const {
  if (anchor_ < 0) return solve_free(x);
  return solve(x - gauge_ * (gauge_inverse_.transpose() * (motions_.transpose() * x)).eval());
}

std::vector<Matrix6d> MarkerInverse::diagonal() const {
  std::vector<Matrix6d> covariances = cholesky_.inverse_diagonal();
  covariances.resize(static_cast<std::size_t>(count_));
  if (anchor_ < 0) return covariances;
  // N⁻ g, with zero rows for the fixed marker.
  const Eigen::MatrixXd cg = solve_free(gauge_);
  const Matrix6d gcg = gauge_.transpose() * cg;
  for (int i = 0; i < count_; ++i) {
    Matrix6d& own = covariances[static_cast<std::size_t>(i)];
    if (i == anchor_) own.setZero();
    const Matrix6d moved = motions_.middleRows<6>(6 * i) * gauge_inverse_;
    const Matrix6d cross = moved * cg.middleRows<6>(6 * i).transpose();
    const Matrix6d full = own - cross - cross.transpose() + moved * gcg * moved.transpose();
    // A difference of large numbers: rounding may leave an eigenvalue a little below zero.
    const SymmetricEigen<6> eigen = symmetric_eigen<6>(0.5 * (full + full.transpose()));
    const Matrix6d root = eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
    own = root * root.transpose();
  }
  return covariances;
}

std::vector<Matrix6d> marker_covariances(const MarkerInformation& information) {
  const auto inverse = MarkerInverse::of(information);
  return inverse ? inverse->diagonal() : std::vector<Matrix6d>{};
}

}  // namespace waymark
