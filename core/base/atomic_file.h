#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// Writes `content` to `path` so that after any failure (full disk, kill, power cut) the file is
/// either as it was before or whole: temporary file in the same folder, fsync, rename, fsync of the
/// folder. Errors: cant_create (folder absent or not writable), permission, io (disk full).
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path,
                                           std::string_view content);

/// Whole content of a regular file. Errors: no_input (absent, a folder, a pipe), permission, io,
/// bad_data (larger than `max_bytes`, or sparse; then nothing of it is read).
[[nodiscard]] Expected<std::string> read_file(const std::filesystem::path& path,
                                              std::size_t max_bytes = std::size_t{1} << 33);

}  // namespace waymark
