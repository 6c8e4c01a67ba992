#include "core/base/output_check.h"

#include <unistd.h>

#include "core/base/same_file.h"

namespace waymark {

namespace fs = std::filesystem;

Status check_writable(const fs::path& path) {
  std::error_code failed;
  if (fs::is_directory(path, failed)) {
    return fail(ErrorKind::cant_create, "{}: can't write: it is a folder; name a file",
                path.string());
  }
  const auto folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const fs::file_status status = fs::status(folder, failed);
  if (status.type() == fs::file_type::none) {
    return fail(
        failed == std::errc::permission_denied ? ErrorKind::permission : ErrorKind::cant_create,
        "{}: can't write: folder {}: {}", path.string(), folder.string(), failed.message());
  }
  if (!fs::is_directory(status)) {
    return fail(ErrorKind::cant_create, "{}: can't write: the folder {} does not exist; create it",
                path.string(), folder.string());
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    return fail(ErrorKind::permission, "{}: can't write: no permission in the folder {}",
                path.string(), folder.string());
  }
  return {};
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
