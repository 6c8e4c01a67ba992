#include "core/base/output_check.h"

#include <fcntl.h>
#include <unistd.h>

#include "core/base/same_file.h"

namespace waymark {

namespace fs = std::filesystem;

namespace {

/// As long as the longest of these: ".rejected.info", ".capture12.3.cam10".
constexpr std::size_t kLongestEnding = 24;

/// By the limits of the file system that it would lie on.
bool is_too_long(fs::path path) {
  path += std::string(kLongestEnding, 'x');
  std::error_code why;
  static_cast<void>(fs::symlink_status(path, why));
  return why == std::errc::filename_too_long;
}

tl::unexpected<Error> cant_write(const fs::path& path, std::string_view why) {
  return fail(ErrorKind::cant_create, "{}: can't write: {}", path.string(), why);
}

}  // namespace

Status check_place(const fs::path& path) {
  if (path.empty()) return cant_write(path, "the name is empty");
  if (is_too_long(path)) {
    return cant_write(
        path, fmt::format("the name is too long; {} bytes are room enough", 255 - kLongestEnding));
  }
  const auto folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code failed;
  const fs::file_status status = fs::status(folder, failed);
  if (status.type() == fs::file_type::none) {
    return fail(
        failed == std::errc::permission_denied ? ErrorKind::permission : ErrorKind::cant_create,
        "{}: can't write: folder {}: {}", path.string(), folder.string(), failed.message());
  }
  if (!fs::is_directory(status)) {
    return cant_write(path,
                      fmt::format("the folder {} does not exist; create it", folder.string()));
  }
  if (::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    return fail(ErrorKind::permission, "{}: can't write: no permission in the folder {}",
                path.string(), folder.string());
  }
  return {};
}

Status check_writable(const fs::path& named) {
  const auto path = behind_links(named);
  if (!path) return cant_write(named, "links that lead in circles; name a file");
  std::error_code ignored;
  const fs::file_status status = fs::status(*path, ignored);
  if (fs::is_directory(status)) return cant_write(*path, "it is a folder; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return cant_write(*path, "it is no regular file; name a file");
  }
  return check_place(*path);
}

Status check_spares(const fs::path& output, const std::vector<fs::path>& inputs,
                    const char* remedy) {
  for (const fs::path& input : inputs) {
    if (!is_same_file(output, input)) continue;
    return fail(ErrorKind::usage, "{}: would take the place of what is read from it; {}",
                output.string(), remedy);
  }
  return {};
}

Status check_differ(const std::vector<fs::path>& outputs, const char* kinds) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!is_same_file(outputs[i], outputs[j])) continue;
      return fail(ErrorKind::usage, "{}: would be two of {}; name a file for each",
                  outputs[i].string(), kinds);
    }
  }
  return {};
}

}  // namespace waymark
