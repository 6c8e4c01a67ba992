#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "core/base/error.h"

namespace waymark {

/// Of the marks that begin, part and end values ([ ] { } , : ? - & * and others, and line ends) a
/// rig of 200 cameras has 20,000. Each may be two values of half a kilobyte each in memory.
inline constexpr std::size_t kMaxYamlMarks = std::size_t{1} << 15;

/// Parses YAML; the one place where any is. What is larger than kMaxCamchainBytes, has more marks
/// or is no YAML is bad_data that names `name`, which stands for the path in messages. How deep it
/// nests the parser bounds itself.
[[nodiscard]] Expected<YAML::Node> parse_yaml(const std::string& text, const std::string& name);

}  // namespace waymark
