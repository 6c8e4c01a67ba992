#pragma once

#include <filesystem>

namespace waymark {

/// Whether writing to one path would take the other's place: one file under two names, or, where
/// there is none yet, one place. Where links lead in circles or a folder can't be looked into, the
/// paths as they are written decide.
[[nodiscard]] bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace waymark
