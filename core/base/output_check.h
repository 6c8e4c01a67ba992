#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"

namespace waymark {

/// Fails early, before long work, when nothing can be made at `path`: its folder is absent or not
/// writable, or its name is so long that there is no room for the endings of what is written beside
/// it (".rejected.info"): 231 bytes, where a name may have 255.
[[nodiscard]] Status check_place(const std::filesystem::path& path);

/// The same of a file, which may be there already; not as a folder or device.
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
