#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/estimate/marker_observation.h"

namespace waymark {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Matrix86 = Eigen::Matrix<double, 8, 6>;

/// Numbers of one camera's calibration that may be wrong: rig_from_cam (Rigid3's tangent in rig
/// axes, m and rad), focal length (share), principal point (px), first lens coefficient that bends,
/// edges (px outward), stamp (s), read-out time (s).
inline constexpr int kCalibrationNumbers = 13;
using CalibrationVector = Eigen::Matrix<double, kCalibrationNumbers, 1>;
using CalibrationColumns = Eigen::Matrix<double, 8, kCalibrationNumbers>;
inline constexpr int kFocal = 6;
inline constexpr int kPrincipal = 7;
inline constexpr int kFirstLens = 9;
inline constexpr int kEdge = 10;
inline constexpr int kStamp = 11;
inline constexpr int kReadout = 12;

/// What may be wrong with one observation, to first order: y = J_x x + J_v v + J_m d + J_e e +
/// J_s s + ε, where every error is true minus used: x of world_from_rig, v of its velocity, d of
/// world_from_marker, e of the camera's calibration, s of the marker's size (share), ε the corners'
/// noise. All in px until whitened.
struct ErrorColumns {
  Vector8d residual;
  Matrix86 by_pose;
  Matrix86 by_velocity;
  Matrix86 by_marker;
  CalibrationColumns by_camera;
  Vector8d by_size;

  /// What depends on nothing and is wrong by so much.
  [[nodiscard]] static ErrorColumns none(double residual);
  /// In units of errors with this covariance: with L Lᵀ = Σ everything is multiplied by L⁻¹.
  void whiten(const Matrix8d& covariance);
};

/// When an observation's corners were seen: each one's instant less the pose's, and where its row
/// lies between the first (−½) and the last (½).
struct CornerTimes {
  std::array<double, 4> after_s{};
  std::array<double, 4> row{};
};

/// nullopt when a corner can't be projected. `velocity` of the rig (world axes) tells what stamps
/// and read-outs do.
[[nodiscard]] std::optional<ErrorColumns> error_columns(const MarkerObservation& observation,
                                                        const ObservationGeometry& geometry,
                                                        const CornerTimes& times,
                                                        const Vector6d& velocity);

}  // namespace waymark
