#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// No file of ours is larger, or nests tables, arrays and the parts of a dotted key deeper. Parser
/// and destructors recurse once per level, so the depth is bounded before anything is parsed.
inline constexpr std::size_t kMaxTomlBytes = std::size_t{1} << 20;
inline constexpr int kMaxTomlDepth = 16;
/// Each dot of a key may be a table of its own, a hundred times its size in memory. A survey of a
/// mebibyte has 52,000, most of them in numbers.
inline constexpr std::size_t kMaxTomlDots = std::size_t{1} << 16;

/// Parses TOML; the one place where any is. What is too large, nested too deep or no TOML is an
/// `error` (bad_data, or config for configuration files) that names `name`, which stands for the
/// path in messages, and the line.
[[nodiscard]] Expected<toml::table> parse_toml(std::string_view text, const std::string& name,
                                               ErrorKind error = ErrorKind::bad_data);

/// The same from a file. Errors of read_file besides.
[[nodiscard]] Expected<toml::table> read_toml(const std::filesystem::path& path,
                                              ErrorKind error = ErrorKind::bad_data);

/// "name: line 12", for messages about a parsed value.
[[nodiscard]] std::string toml_place(const std::string& name, const toml::node& node);

/// Fails on the first key of `table` that is not in `known`, so that a misspelt key is not ignored.
[[nodiscard]] Status check_toml_keys(const toml::table& table,
                                     std::initializer_list<std::string_view> known,
                                     const std::string& name,
                                     ErrorKind error = ErrorKind::bad_data);

}  // namespace waymark
