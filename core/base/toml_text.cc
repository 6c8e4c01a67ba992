#include "core/base/toml_text.h"

#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/base/one_line.h"

namespace waymark {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;

}  // namespace

Expected<toml::table> parse_toml(std::string_view text, const std::string& name, ErrorKind error) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& bad) {
    return fail(error, "{}: line {}: not valid TOML: {}", name, bad.source().begin.line,
                in_one_line(bad.description()));
  }
}

Expected<toml::table> read_toml(const std::filesystem::path& path, ErrorKind error) {
  const auto text = read_file(path, kMaxBytes);
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
