#include "core/camera/kalibr_node.h"

#include <fmt/format.h>

#include <cmath>

namespace waymark {

std::string KalibrNode::place(std::string_view key, const YAML::Node& at) const {
  const YAML::Mark mark = at.IsDefined() ? at.Mark() : node_.Mark();
  return fmt::format("{}: line {}: {}{}{}", file_, mark.line + 1, camera_, key.empty() ? "" : ": ",
                     key);
}

tl::unexpected<Error> KalibrNode::wrong(std::string_view key, const YAML::Node& at,
                                        std::string_view why, std::optional<Cause> cause) const {
  return tl::make_unexpected(
      Error{ErrorKind::bad_data, fmt::format("{}: {}", place(key, at), why), cause});
}

Expected<double> KalibrNode::read_number(std::string_view key, const YAML::Node& at) const {
  double value = 0;
  if (!at.IsScalar() || !YAML::convert<double>::decode(at, value)) {
    return wrong(key, at, "is no number");
  }
  if (!std::isfinite(value)) return wrong(key, at, "is not finite");
  return value;
}

Expected<std::vector<double>> KalibrNode::read_numbers(std::string_view key, const YAML::Node& at,
                                                       std::size_t count) const {
  if (!at.IsDefined()) return wrong(key, at, "is missing");
  if (!at.IsSequence() || at.size() != count) {
    return wrong(
        key, at,
        fmt::format("{} instead of a list of {} numbers",
                    at.IsSequence() ? fmt::format("a list of {}", at.size()) : "something else",
                    count));
  }
  std::vector<double> values;
  for (const auto& item : at) {
    const auto value = read_number(key, item);
    if (!value) return tl::make_unexpected(value.error());
    values.push_back(*value);
  }
  return values;
}

Expected<std::string> KalibrNode::read_text(std::string_view key) const {
  const YAML::Node at = node_[std::string(key)];
  if (!at.IsDefined()) return wrong(key, at, "is missing");
  if (!at.IsScalar()) return wrong(key, at, "is no text");
  return at.Scalar();
}

}  // namespace waymark
