#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "mapbuilder/diagnosis/camera_tracks.h"
#include "mapbuilder/diagnosis/rig_agreement.h"

namespace waymark::tests {

/// A rig driven along a bending path, its cameras' places with noise of a millimetre and a
/// twentieth of a degree; some are missing, some grossly off.
struct SimulatedDrive {
  int instants = 50;
  double period_s = 0.1;
  double speed_mps = 0.8;
  double turn_rad_per_s = 0.5;
  double gross_share = 0.03;
  double missing_share = 0.1;
  unsigned seed = 1;
};

inline Rigid3 turned_by(double degrees, const Eigen::Vector3d& axis, const Eigen::Vector3d& at) {
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized())),
      at};
}

/// Cameras on a circle of 0.2 m around the rig's middle, every `step_deg`, looking outwards and
/// each a little more downwards, so that no mirror makes the rig its own; the first is the rig's
/// frame.
inline Extrinsics ring_of_cameras(std::size_t count, double step_deg) {
  Extrinsics rig;
  for (std::size_t k = 0; k < count; ++k) {
    const double angle = step_deg * static_cast<double>(k);
    // Camera axes: x right, y down, z forward; turning about y.
    const Rigid3 turned = turned_by(angle, Eigen::Vector3d::UnitY(), Eigen::Vector3d::Zero());
    const Eigen::Vector3d forward(0, 0, 0.2);
    const Rigid3 down =
        turned_by(-4.0 * static_cast<double>(k), Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
    rig.push_back({turned.rotation * down.rotation,
                   turned.rotation * forward - forward +
                       Eigen::Vector3d(0, 0.03 * static_cast<double>(k * k), 0)});
  }
  return rig;
}

inline Rigid3 driven_pose(const SimulatedDrive& drive, double time_s) {
  const double heading = drive.turn_rad_per_s * std::sin(0.7 * time_s) / 0.7 + 0.1 * time_s;
  const Eigen::Vector3d at(drive.speed_mps * time_s, 0.3 * std::sin(0.5 * time_s),
                           0.8 * std::sin(0.9 * time_s));
  return turned_by(heading * 180.0 / std::numbers::pi, Eigen::Vector3d(0.05, 1, 0.02), at);
}

/// What the cameras of `truth` see; camera `late` shows what was `late_s` ago.
inline CameraTracks drive_tracks(const SimulatedDrive& drive, const Extrinsics& truth,
                                 int late = -1, double late_s = 0) {
  std::mt19937 random(drive.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto noise = [&](double position_m, double rotation_rad) {
    Vector6d delta;
    for (int i = 0; i < 3; ++i) {
      delta[i] = position_m * normal(random);
      delta[i + 3] = rotation_rad * normal(random);
    }
    return delta;
  };
  constexpr double kPosition_m = 0.001;
  constexpr double kRotation_rad = 0.0009;
  CameraTracks tracks;
  for (std::size_t k = 0; k < truth.size(); ++k)
    tracks.cameras.push_back("cam" + std::to_string(k));
  for (int i = 0; i < drive.instants; ++i) {
    CameraTracks::Instant instant;
    const double time_s = drive.period_s * i;
    instant.stamp = Stamp(1'700'000'000'000'000'000 + static_cast<std::int64_t>(1e9 * time_s));
    for (std::size_t k = 0; k < truth.size(); ++k) {
      if (uniform(random) < drive.missing_share) {
        instant.places.emplace_back();
        continue;
      }
      const bool is_late = static_cast<int>(k) == late;
      const Rigid3 rig = driven_pose(drive, time_s - (is_late ? late_s : 0.0));
      const bool gross = uniform(random) < drive.gross_share;
      TrackedPlace place;
      place.world_from_cam =
          (rig * truth[k]).plus(gross ? noise(0.5, 0.5) : noise(kPosition_m, kRotation_rad));
      place.information = Matrix6d::Zero();
      place.information.diagonal() << Eigen::Vector3d::Constant(1 / (kPosition_m * kPosition_m)),
          Eigen::Vector3d::Constant(1 / (kRotation_rad * kRotation_rad));
      instant.places.emplace_back(place);
    }
    tracks.instants.push_back(std::move(instant));
  }
  return tracks;
}

}  // namespace waymark::tests
