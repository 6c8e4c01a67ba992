#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"

namespace YAML {
class Node;
}

namespace waymark {

/// What a camchain says of its own errors in one camera's node: `sigma` and `sigma_source` go into
/// `camera`, `sigma_joint` is returned as it is written, empty where it is not. `file` is named in
/// errors (bad_data, with line, camera and key): unknown keys, what is no number, not finite, not
/// above zero or out of reason. yaml-cpp may throw.
[[nodiscard]] Expected<std::vector<double>> read_kalibr_sigmas(const YAML::Node& node,
                                                               const std::string& file,
                                                               RigCamera& camera);

/// Holds the stated sigmas against a rig whose cameras have their places, and makes its joint
/// sigmas of `sigma_joint`, the lower triangle row by row in the order of rig_parameters and the
/// units of the keys of `sigma`; empty: it has none. bad_data for a sigma of a parameter that the
/// rig lacks, and for a triangle of another length, not positive definite, or that contradicts the
/// sigmas beside it.
[[nodiscard]] Status take_joint_sigmas(const std::vector<double>& sigma_joint,
                                       const std::string& file, Rig& rig);

/// The keys' text within a camera's entry; `rig.joint_sigmas` stand at the first camera. Empty
/// where nothing is stated.
[[nodiscard]] std::string format_kalibr_sigmas(const Rig& rig, std::size_t camera);

}  // namespace waymark
