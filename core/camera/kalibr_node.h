#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace waymark {

/// The map of keys under one camera of a camchain. Every error is bad_data with file, line, camera
/// and key.
class KalibrNode {
 public:
  /// All three must outlive it.
  KalibrNode(const std::string& file, const std::string& camera, const YAML::Node& node)
      : file_(file), camera_(camera), node_(node) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& camera() const { return camera_; }
  [[nodiscard]] const YAML::Node& node() const { return node_; }
  /// The value of a key; undefined where it is not there.
  [[nodiscard]] YAML::Node at(std::string_view key) const { return node_[std::string(key)]; }

  /// "rig.yaml: line 4: cam0: key".
  [[nodiscard]] std::string place(std::string_view key, const YAML::Node& at) const;
  [[nodiscard]] tl::unexpected<Error> wrong(std::string_view key, const YAML::Node& at,
                                            std::string_view why,
                                            std::optional<Cause> cause = std::nullopt) const;

  /// One finite number.
  [[nodiscard]] Expected<double> read_number(std::string_view key, const YAML::Node& at) const;
  /// `count` finite numbers.
  [[nodiscard]] Expected<std::vector<double>> read_numbers(std::string_view key,
                                                           const YAML::Node& at,
                                                           std::size_t count) const;
  [[nodiscard]] Expected<std::string> read_text(std::string_view key) const;

 private:
  const std::string& file_;
  const std::string& camera_;
  const YAML::Node& node_;
};

}  // namespace waymark
