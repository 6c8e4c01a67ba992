#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/check.h"
#include "core/camera/rig_parameters.h"
#include "core/geometry/symmetric_factor.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/pose_gate.h"
#include "simulator/rig_library.h"
#include "simulator/scene_library.h"

namespace waymark::bench {

inline constexpr double kDeg = 180.0 / std::numbers::pi;

inline simulator::Scene scene_named(const std::string& name) {
  auto scene = simulator::load_scene(name);
  WAYMARK_CHECK(scene.has_value());
  return *scene;
}

/// Known without any error, as what locd is told of it.
inline Rig rig_named(const std::string& name) {
  auto rig = simulator::load_rig(name);
  WAYMARK_CHECK(rig.has_value());
  return stated_exact(rig->rig);
}

/// Errors of poses, and what was claimed of them.
struct Errors {
  int sets = 0;
  double position2 = 0, rotation2 = 0, nees = 0;
  double worst_m = 0, worst_rad = 0;
  int beyond = 0;  ///< farther than 20 mm and 3 sigma, or 0.5° and 3 sigma

  void add(const PoseEstimate& estimate, const Rigid3& truth) {
    const Vector6d error = estimate.world_from_rig.minus(truth);
    const double off_m = error.head<3>().norm();
    const double off_rad = error.tail<3>().norm();
    const PoseSigmas sigmas = worst_sigmas(estimate.covariance);
    ++sets;
    position2 += off_m * off_m;
    rotation2 += off_rad * off_rad;
    nees += error.dot(SymmetricFactor<6>(estimate.covariance).solve(error));
    worst_m = std::max(worst_m, off_m);
    worst_rad = std::max(worst_rad, off_rad);
    if ((off_m > 0.020 && off_m > 3 * sigmas.position_m) ||
        (off_rad > 0.5 / kDeg && off_rad > 3 * sigmas.rotation_rad)) {
      ++beyond;
    }
  }
  [[nodiscard]] double rmse_m() const { return std::sqrt(position2 / std::max(1, sets)); }
  [[nodiscard]] double rmse_rad() const { return std::sqrt(rotation2 / std::max(1, sets)); }
};

}  // namespace waymark::bench
