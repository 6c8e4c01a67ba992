#include "mapbuilder/upkeep/considered_marker.h"

namespace waymark {

void consider(const MapMarker* before, const Rigid3& old_from_round, MapMarker& marker) {
  const bool stood = before != nullptr && before->considered();
  if (!stood && !marker.considered()) return;
  const ModeSensitivity kept = stood ? before->modes : ModeSensitivity::Zero();
  const Eigen::Matrix<double, 6, kMapModes> modes =
      stood ? Eigen::Matrix<double, 6, kMapModes>(kept.cast<double>())
            : left_motion_jacobian(old_from_round) * marker.modes.cast<double>();
  marker.covariance_metric = marker.covariance + modes * modes.transpose();
  marker.modes = kept;
}

}  // namespace waymark
