#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"

namespace YAML {
class Node;
}

namespace waymark {

/// One camera of a camchain as written, before the chain is followed: `camera.rig_from_cam` is not
/// set yet.
struct KalibrCamera {
  RigCamera camera;
  std::optional<Rigid3> cam_from_previous;  ///< T_cn_cnm1
  std::optional<Rigid3> cam_from_body;      ///< T_cam_imu
  std::vector<double> sigma_joint{};        ///< as written; empty where it is not
};

/// Reads the keys under `camera` (cam0, cam1, …) of the camchain `file`; what the user should know
/// is appended to `notes`. bad_data with file, line, camera and key. yaml-cpp may throw.
[[nodiscard]] Expected<KalibrCamera> read_kalibr_camera(const YAML::Node& node,
                                                        const std::string& camera,
                                                        const std::string& file,
                                                        std::vector<std::string>& notes);

}  // namespace waymark
