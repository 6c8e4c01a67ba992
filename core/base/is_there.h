#pragma once

#include <filesystem>
#include <system_error>

namespace waymark {

/// Whether anything has that name: also a link that leads nowhere or in circles, and what can't be
/// looked at. An optional file is absent where nothing has its name; what has it is to be read, and
/// whoever reads it says why that is not possible.
[[nodiscard]] inline bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::symlink_status(path, ignored).type() !=
         std::filesystem::file_type::not_found;
}

}  // namespace waymark
