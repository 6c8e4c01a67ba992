#include "core/map/marker_distance.h"

#include <cmath>

namespace waymark {

MarkerDistance distance_between(const MapMarker& from, const MapMarker& to, FrameKind frame) {
  const Eigen::Vector3d apart =
      to.world_from_marker.translation - from.world_from_marker.translation;
  MarkerDistance result;
  result.distance_m = apart.norm();
  const bool known = from.covariance_known() && to.covariance_known();
  if (!known || !(result.distance_m > 0)) return result;
  const Eigen::Vector3d along = apart / result.distance_m;
  const auto variance = [&](const MapMarker& marker) {
    return std::max(0.0, along.dot(marker.covariance.topLeftCorner<3, 3>() * along));
  };
  const double first = variance(from);
  const double second = variance(to);
  result.sigma_m = std::sqrt(first + second);
  result.sigma_bound_m = std::sqrt(first) + std::sqrt(second);
  if (frame != FrameKind::arbitrary) result.sigma_metric_m = result.sigma_bound_m;
  return result;
}

}  // namespace waymark
