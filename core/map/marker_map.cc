#include "core/map/marker_map.h"

#include <algorithm>
#include <limits>

#include "core/geometry/decompositions.h"

namespace waymark {

Matrix6d unknown_covariance() {
  return Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN());
}

bool MapMarker::covariance_known() const { return covariance.allFinite(); }

bool MapMarker::considered() const { return covariance_metric.allFinite(); }

const Matrix6d& MapMarker::metric() const { return considered() ? covariance_metric : covariance; }

Matrix6d MapMarker::own_covariance() const {
  if (!metric().allFinite()) return unknown_covariance();
  const Eigen::Matrix<double, 6, kMapModes> shared = modes.cast<double>();
  if (shared.isZero(0)) return metric();
  // By its own sigmas, for metres and radians do not compare; rounding leaves a little below zero.
  const Vector6d sigmas = metric().diagonal().cwiseMax(0).cwiseSqrt();
  const Vector6d scale = (sigmas.array() > 0).select(sigmas.cwiseInverse(), Vector6d::Zero());
  const Matrix6d left = metric() - shared * shared.transpose();
  const SymmetricEigen<6> eigen =
      symmetric_eigen<6>(Matrix6d(scale.asDiagonal() * left * scale.asDiagonal()));
  const Matrix6d root =
      sigmas.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  return root * root.transpose();
}

void move_marker(const Rigid3& new_from_old, MapMarker& marker) {
  const Matrix6d turn = left_motion_jacobian(new_from_old);
  const auto turned = [&](const Matrix6d& covariance) {
    const Matrix6d result = turn * covariance * turn.transpose();
    return Matrix6d(0.5 * (result + result.transpose()));
  };
  marker.world_from_marker = new_from_old * marker.world_from_marker;
  marker.covariance = turned(marker.covariance);
  marker.covariance_metric = turned(marker.covariance_metric);
  marker.modes = (turn * marker.modes.cast<double>()).cast<float>();
}

bool MarkerMap::considered() const {
  return std::any_of(submaps.begin(), submaps.end(), [](const SubMap& submap) {
    return !submap.parameters.empty() ||
           std::any_of(submap.markers.begin(), submap.markers.end(),
                       [](const MapMarker& marker) { return marker.considered(); });
  });
}

MeetingFamilies MarkerMap::families() const {
  MeetingFamilies families;
  for (const SubMap& submap : submaps) {
    for (const MapMarker& marker : submap.markers) families.add(marker.id.family);
  }
  return families;
}

}  // namespace waymark
