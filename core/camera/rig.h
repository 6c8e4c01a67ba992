#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/range.h"
#include "core/camera/camera_model.h"
#include "core/camera/camera_sigmas.h"
#include "core/camera/sensor_response.h"
#include "core/geometry/rigid3.h"

namespace waymark {

/// One camera of a rig.
struct RigCamera {
  std::string name;  ///< cam0, cam1, … in rig.yaml's order
  CameraModel model;
  Rigid3 rig_from_cam;
  std::string serial;                ///< empty when not stated
  std::string lens_id;               ///< empty when not stated
  std::optional<double> readout_us;  ///< rolling-shutter read-out time of the whole image, µs
  std::optional<bool> global_shutter;
  std::optional<double> timeshift_cam_imu_s;  ///< printed, never used
  StatedSigmas stated_sigmas{};               ///< what the rig file says of its own errors
  std::optional<SigmaSource> sigma_source{};  ///< nullopt: Kalibr's
  /// How far our detector sees edges inside the black (px); nullopt: not stated.
  std::optional<double> edge_bias_px{};
  std::optional<SensorResponse> response{};  ///< nullopt: not stated (auto)

  static constexpr Range kReadout_us{0, 1e6};
  static constexpr Range kEdgeBias_px{-3, 3};
};

/// Cameras with fixed, known places on one rigid body.
struct Rig {
  std::vector<RigCamera> cameras;
  bool has_extrinsics = true;  ///< false: several cameras, no transforms; good for mono use only
  /// Covariance of rig_parameters (rig_parameters.h, whose units), of a refined rig file.
  std::optional<Eigen::MatrixXd> joint_sigmas{};
};

}  // namespace waymark
