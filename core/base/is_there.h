#pragma once

#include <filesystem>
#include <string_view>
#include <system_error>

#include "core/base/error.h"

namespace waymark {

/// Whether anything has that name: also a link that leads nowhere or in circles, and what can't be
/// looked at. An optional file is absent where nothing has its name; what has it is to be read, and
/// whoever reads it says why that is not possible.
[[nodiscard]] inline bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::symlink_status(path, ignored).type() !=
         std::filesystem::file_type::not_found;
}

/// The error of what was not found to be read: no_input, "path: text"; permission where a folder
/// above forbids to look, so that nobody knows.
[[nodiscard]] inline tl::unexpected<Error> absent(const std::filesystem::path& path,
                                                  std::string_view text) {
  std::error_code why;
  static_cast<void>(std::filesystem::status(path, why));
  if (why == std::errc::permission_denied) {
    return fail(ErrorKind::permission, "{}: can't look at it: {}", path.string(), why.message());
  }
  return fail(ErrorKind::no_input, "{}: {}", path.string(), text);
}

}  // namespace waymark
