#include "bench/map_nees.h"

#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "mapbuilder/evaluate/evaluation.h"

namespace waymark::bench {
namespace {

/// Of correlations: directions that the gauge has taken out are below.
constexpr double kRank = 1e-7;

/// eᵀ C⁺ e and the rank of C.
std::pair<double, double> squared_in_sigmas(const Eigen::MatrixXd& covariance,
                                            const Eigen::VectorXd& error) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * covariance *
                                                             scale.asDiagonal());
  const Eigen::VectorXd along = eigen.eigenvectors().transpose() * scale.cwiseProduct(error);
  double sum = 0;
  double rank = 0;
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    if (eigen.eigenvalues()[i] < kRank) continue;
    sum += along[i] * along[i] / eigen.eigenvalues()[i];
    rank += 1;
  }
  return {sum, rank};
}

}  // namespace

MapNees map_nees(const SubMap& map, const std::map<MarkerId, Rigid3>& truth) {
  const MarkerEvaluation evaluation = evaluate_markers(map, truth);
  WAYMARK_CHECK(evaluation.errors && evaluation.found.size() == map.markers.size());
  const Rigid3 map_from_truth = evaluation.errors->truth_from_estimate.inverse();
  const auto count = static_cast<Eigen::Index>(map.markers.size());
  Eigen::VectorXd error(6 * count);
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(6 * count, 6 * count);
  Eigen::MatrixXd modes(6 * count, kMapModes);
  MapNees nees;
  for (Eigen::Index i = 0; i < count; ++i) {
    const MapMarker& marker = map.markers[static_cast<std::size_t>(i)];
    const Vector6d one = (map_from_truth * truth.at(marker.id)).minus(marker.world_from_marker);
    error.segment<6>(6 * i) = one;
    joint.block<6, 6>(6 * i, 6 * i) = marker.own_covariance();
    modes.middleRows<6>(6 * i) = marker.modes.cast<double>();
    const auto share = static_cast<double>(count);
    nees.markers += squared_in_sigmas(marker.metric(), one).first / 6 / share;
    nees.within += squared_in_sigmas(marker.covariance, one).first / 6 / share;
    nees.error_m += one.head<3>().squaredNorm() / share;
    nees.sigma_m += marker.metric().topLeftCorner<3, 3>().trace() / share;
  }
  joint += modes * modes.transpose();
  const auto [sum, rank] = squared_in_sigmas(joint, error);
  nees.joint = sum / rank;
  nees.error_m = std::sqrt(nees.error_m);
  nees.sigma_m = std::sqrt(nees.sigma_m);
  return nees;
}

}  // namespace waymark::bench
