#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>

#include "core/base/error.h"

namespace waymark {

/// A calibration of one camera that another program wrote, as the camchain that it means: ROS's
/// camera_info, and OpenCV's FileStorage as its samples write it. nullopt: it is neither.
/// bad_data (format) where it is one and a part is missing, or its lens has no model here.
[[nodiscard]] Expected<std::optional<YAML::Node>> camchain_of_foreign(const YAML::Node& root,
                                                                      const std::string& name);

/// OpenCV's FileStorage begins with a directive that is no YAML; it becomes a comment, so that
/// lines keep their numbers.
[[nodiscard]] std::string without_opencv_directive(std::string text);

}  // namespace waymark
