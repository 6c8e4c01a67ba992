#include "core/base/toml_text.h"

#include <algorithm>
#include <optional>

#include "core/base/atomic_file.h"

namespace waymark {
namespace {

/// Bytes of the string that `text` begins with, its quotes included; to the end where it has none.
std::size_t string_length(std::string_view text) {
  const char quote = text[0];
  const std::string_view closing = quote == '"' ? "\"\"\"" : "'''";
  const bool several_lines = text.starts_with(closing);
  std::size_t at = several_lines ? 3 : 1;
  for (; at < text.size(); ++at) {
    if (text[at] == '\\' && quote == '"') {
      ++at;
    } else if (!several_lines && text[at] == '\n') {
      return at;  // no string; the parser says so
    } else if (!several_lines && text[at] == quote) {
      return at + 1;
    } else if (several_lines && text.substr(at).starts_with(closing)) {
      // One or two quotes may stand before the three that close.
      const std::string_view end = text.substr(at, 5);
      return at + std::min(end.find_first_not_of(quote), end.size());
    }
  }
  return text.size();
}

/// The line on which there are too many dots, or brackets or the dots of one key nest too deep.
std::optional<std::size_t> too_deep_line(std::string_view text) {
  std::size_t line = 1;
  std::size_t all_dots = 0;
  int brackets = 0;
  int dots = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    std::size_t length = 1;
    if (c == '"' || c == '\'') {
      length = string_length(text.substr(at));
    } else if (c == '#') {
      length = std::min(text.find('\n', at), text.size()) - at;
    } else if (c == '.') {
      ++dots;
      ++all_dots;
    } else if (c == '[' || c == '{') {
      ++brackets;
    } else if (c == ']' || c == '}') {
      brackets = std::max(brackets - 1, 0);
    }
    // What ends a key.
    if (std::string_view("[]{},=\n").find(c) != std::string_view::npos) dots = 0;
    if (brackets > kMaxTomlDepth || dots > kMaxTomlDepth || all_dots > kMaxTomlDots) return line;
    const std::string_view passed = text.substr(at, length);
    line += static_cast<std::size_t>(std::count(passed.begin(), passed.end(), '\n'));
    at += length;
  }
  return std::nullopt;
}

Status check_bounds(std::string_view text, const std::string& name, ErrorKind error) {
  if (text.size() > kMaxTomlBytes) {
    return fail(error, "{}: larger than {} bytes; this is not such a file", name, kMaxTomlBytes);
  }
  if (const auto line = too_deep_line(text)) {
    return fail(error,
                "{}: line {}: nested deeper than {} levels, or more than {} dots; this is not "
                "such a file",
                name, *line, kMaxTomlDepth, kMaxTomlDots);
  }
  return {};
}

}  // namespace

Expected<toml::table> parse_toml(std::string_view text, const std::string& name, ErrorKind error) {
  if (auto bounded = check_bounds(text, name, error); !bounded) {
    return tl::make_unexpected(bounded.error());
  }
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& bad) {
    return fail(error, "{}: line {}: not valid TOML: {}", name, bad.source().begin.line,
                bad.description());
  }
}

Expected<toml::table> read_toml(const std::filesystem::path& path, ErrorKind error) {
  const auto text = read_file(path, kMaxTomlBytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_toml(*text, path.string(), error);
}

std::string toml_place(const std::string& name, const toml::node& node) {
  return fmt::format("{}: line {}", name, node.source().begin.line);
}

Status check_toml_keys(const toml::table& table, std::initializer_list<std::string_view> known,
                       const std::string& name, ErrorKind error) {
  for (const auto& [key, value] : table) {
    if (std::find(known.begin(), known.end(), key.str()) == known.end()) {
      return fail(error, "{}: unknown key \"{}\"; known here: {}", toml_place(name, value),
                  key.str(), fmt::join(known, ", "));
    }
  }
  return {};
}

}  // namespace waymark
