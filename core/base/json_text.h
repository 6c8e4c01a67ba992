#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// No document of ours nests objects and lists deeper.
inline constexpr int kMaxJsonDepth = 8;
/// What a document's values may take in memory: a share of its length, and as much for any.
inline constexpr std::size_t kJsonBytesPerByte = 10;
inline constexpr std::size_t kJsonBytesForAny = std::size_t{40} << 20;

/// Parses JSON from outside; the one place where any is. `name` stands for the path in messages.
/// bad_data for what is larger than `max_bytes`, is no JSON (with line and column), nests too deep,
/// names a member twice, or consists of more small values than a document of ours could. A target
/// that includes this header links nlohmann_json.
[[nodiscard]] Expected<nlohmann::json> parse_json(std::string_view text, const std::string& name,
                                                  std::size_t max_bytes);

/// The same from a file. Errors of read_file besides.
[[nodiscard]] Expected<nlohmann::json> read_json(const std::filesystem::path& path,
                                                 std::size_t max_bytes);

}  // namespace waymark
