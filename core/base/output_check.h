#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"

namespace waymark {

/// Fails early, before long work, when `path` can't be written: its folder is absent or not
/// writable, or it is a folder.
[[nodiscard]] Status check_writable(const std::filesystem::path& path);

/// Fails (usage) when `output` would take the place of one of the `inputs`; `remedy` ends the line.
/// Of a capture's files: check_spares_captures.
[[nodiscard]] Status check_spares(const std::filesystem::path& output,
                                  const std::vector<std::filesystem::path>& inputs,
                                  const char* remedy = "name another file");

/// Fails (usage) when two of the `outputs` are one file; `kinds` says which they would be.
[[nodiscard]] Status check_differ(const std::vector<std::filesystem::path>& outputs,
                                  const char* kinds);

}  // namespace waymark
