#pragma once

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>

#include "core/base/error.h"

namespace waymark {

/// Why the last system call failed, in words.
[[nodiscard]] inline std::string system_reason() {
  return std::error_code(errno, std::generic_category()).message();
}

/// The error of a system call that failed to create something: not allowed, or not possible.
[[nodiscard]] inline ErrorKind creation_error() {
  return errno == EACCES || errno == EPERM || errno == EROFS ? ErrorKind::permission
                                                             : ErrorKind::cant_create;
}

/// Writes all bytes, however the system parts them; false, with errno, when it can't.
[[nodiscard]] bool write_all(int descriptor, std::string_view bytes);

}  // namespace waymark
