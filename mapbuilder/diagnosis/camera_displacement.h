#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera/rig.h"

namespace waymark {

/// How far a camera stands from where the rig file has it, seen from a reference camera that stands
/// where the file says; with standard deviations.
struct CameraDisplacement {
  double moved_m = 0;
  double turned_rad = 0;
  double moved_sigma_m = 0;
  double turned_sigma_rad = 0;

  /// By more than chance (5 sigmas) and than any rig file leaves (2 mm, 0.1°).
  [[nodiscard]] bool is_worth_naming() const;
};

/// Of each camera. `covariance` of the fitted rig_from_cam, six per camera (Rigid3's tangent);
/// sigmas are the largest of any direction.
[[nodiscard]] std::vector<CameraDisplacement> camera_displacements(
    const Rig& stated, const Rig& fitted, const Eigen::MatrixXd& covariance, std::size_t reference);

/// The reference by which the fewest cameras are displaced, but one at least, the first of several:
/// images tell cameras' places to each other only, and when all others have moved alike, it was the
/// first.
[[nodiscard]] std::size_t least_displacing_reference(const Rig& stated, const Rig& fitted,
                                                     const Eigen::MatrixXd& covariance);

}  // namespace waymark
