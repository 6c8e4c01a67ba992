#pragma once

#include <filesystem>
#include <optional>

namespace waymark {

/// Where a path leads when it is written to: behind its links, be the file there or not; nullopt
/// for links that lead in circles. A link that can't be read stands for itself.
[[nodiscard]] std::optional<std::filesystem::path> behind_links(const std::filesystem::path& named);

/// Whether writing to one path would take the other's place: one file under two names, or, where
/// there is none yet, one place. Where links lead in circles or a folder can't be looked into, the
/// paths as they are written decide.
[[nodiscard]] bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Whether a file at `path` lies, or would lie, in `folder` or in a folder below it, links
/// followed.
[[nodiscard]] bool is_within(const std::filesystem::path& path,
                             const std::filesystem::path& folder);

}  // namespace waymark
