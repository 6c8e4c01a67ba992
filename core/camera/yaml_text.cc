#include "core/camera/yaml_text.h"

#include <algorithm>
#include <string_view>

#include "core/camera/kalibr.h"

namespace waymark {
namespace {

constexpr std::string_view kMarks = "[]{},:?-&*!|>#%@`'\"\n\r";

Status check_bounds(std::string_view text, const std::string& name) {
  if (text.size() > kMaxCamchainBytes) {
    return fail(ErrorKind::bad_data, "{}: larger than {} bytes; this is not such a file", name,
                kMaxCamchainBytes);
  }
  const auto marks = std::count_if(text.begin(), text.end(),
                                   [](char c) { return kMarks.find(c) != std::string_view::npos; });
  if (static_cast<std::size_t>(marks) > kMaxYamlMarks) {
    return fail(ErrorKind::bad_data,
                "{}: {} commas, brackets, colons, line ends and the like, at most {} are read; "
                "this is not such a file",
                name, marks, kMaxYamlMarks);
  }
  return {};
}

}  // namespace

Expected<YAML::Node> parse_yaml(const std::string& text, const std::string& name) {
  if (auto bounded = check_bounds(text, name); !bounded) {
    return tl::make_unexpected(bounded.error());
  }
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& bad) {
    return fail(ErrorKind::bad_data, "{}: line {}: not valid YAML: {}", name, bad.mark.line + 1,
                bad.msg);
  }
}

}  // namespace waymark
