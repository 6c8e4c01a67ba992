#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>

#include "core/base/error.h"

namespace waymark {

/// A calibration of one camera that another program wrote, as the camchain that it means: ROS's
/// camera_info, and OpenCV's FileStorage as its samples write it. nullopt: it is neither, or has a
/// key of a camchain's camera. bad_data (format) where it is one and a part is missing, is no list
/// of numbers, or means what has no model here: another lens, or a matrix other than
/// fu 0 pu, 0 fv pv, 0 0 1. plumb_bob and rational_polynomial (OpenCV's order, up to eight) become
/// the least of none, radtan and rational that holds them: trailing zeros say nothing, and an empty
/// list is no distortion. equidistant stays what it is with zeros, too.
[[nodiscard]] Expected<std::optional<YAML::Node>> camchain_of_foreign(const YAML::Node& root,
                                                                      const std::string& name);

/// OpenCV's FileStorage begins with a directive that is no YAML; it becomes a comment, so that
/// lines keep their numbers.
[[nodiscard]] std::string without_opencv_directive(std::string text);

}  // namespace waymark
