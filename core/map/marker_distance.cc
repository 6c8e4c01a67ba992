#include "core/map/marker_distance.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

double variance_along(const Eigen::Vector3d& along, const Matrix6d& covariance) {
  return std::max(0.0, along.dot(covariance.topLeftCorner<3, 3>() * along));
}

double metric_sigma(const MapMarker& from, const MapMarker& to, const Eigen::Vector3d& along) {
  const auto shared = [&](const MapMarker& marker) -> Eigen::Matrix<double, 1, kMapModes> {
    return along.transpose() * marker.modes.topRows<3>().cast<double>();
  };
  const double both = shared(from).dot(shared(to));
  return std::sqrt(std::max(
      0.0, variance_along(along, from.metric()) + variance_along(along, to.metric()) - 2 * both));
}

}  // namespace

MarkerDistance distance_between(const MapMarker& from, const MapMarker& to, FrameKind frame) {
  const Eigen::Vector3d apart =
      to.world_from_marker.translation - from.world_from_marker.translation;
  MarkerDistance result;
  result.distance_m = apart.norm();
  const bool known = from.covariance_known() && to.covariance_known();
  if (!known || !(result.distance_m > 0)) return result;
  const Eigen::Vector3d along = apart / result.distance_m;
  const double first = variance_along(along, from.covariance);
  const double second = variance_along(along, to.covariance);
  result.sigma_m = std::sqrt(first + second);
  result.sigma_bound_m = std::sqrt(first) + std::sqrt(second);
  if (from.considered() && to.considered()) {
    result.sigma_metric_m = metric_sigma(from, to, along);
  } else if (frame != FrameKind::arbitrary) {
    result.sigma_metric_m = result.sigma_bound_m;
  }
  return result;
}

}  // namespace waymark
