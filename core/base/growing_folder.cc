#include "core/base/growing_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include "core/base/descriptor.h"
#include "core/base/system_call.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// As the path would be written without "." and a trailing slash.
fs::path cleaned(const fs::path& path) {
  std::error_code failed;
  const fs::path absolute = fs::absolute(path, failed);
  const fs::path normal = (failed ? path : absolute).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

}  // namespace

Status create_folder(const fs::path& path) {
  std::error_code error;
  if (fs::create_directory(path, error) || !error) return {};
  const bool denied =
      error == std::errc::permission_denied || error == std::errc::read_only_file_system;
  return fail(denied ? ErrorKind::permission : ErrorKind::cant_create,
              "{}: can't create folder: {}", path.string(), error.message());
}

Expected<GrowingFolder> GrowingFolder::begin(const fs::path& final_path) {
  std::error_code ignored;
  const fs::path place = cleaned(final_path);
  if (fs::exists(place, ignored) &&
      !(fs::is_directory(place, ignored) && fs::is_empty(place, ignored))) {
    return fail(ErrorKind::cant_create,
                "{}: exists already; name another folder or remove this one first",
                final_path.string());
  }
  if (!fs::is_directory(place.parent_path(), ignored)) {
    return fail(ErrorKind::cant_create, "{}: can't create: there is no folder {}",
                final_path.string(), place.parent_path().string());
  }
  const fs::path growing =
      place.parent_path() / fmt::format(".{}.{}.partial", place.filename().string(), ::getpid());
  if (auto status = create_folder(growing); !status) return tl::make_unexpected(status.error());
  return GrowingFolder(place, growing);
}

GrowingFolder::GrowingFolder(GrowingFolder&& other) noexcept
    : final_path_(std::move(other.final_path_)), path_(std::move(other.path_)) {
  other.path_.clear();
}

GrowingFolder::~GrowingFolder() {
  if (path_.empty()) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

Status GrowingFolder::finish() {
  const Descriptor folder(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.valid() || ::syncfs(folder.get()) != 0) {
    return fail(ErrorKind::io, "{}: can't write: {}", final_path_.string(), system_reason());
  }
  std::error_code error;
  fs::rename(path_, final_path_, error);
  if (error) {
    return fail(ErrorKind::cant_create, "{}: can't move the finished folder here: {}",
                final_path_.string(), error.message());
  }
  path_.clear();
  return {};
}

Status write_new_file(const fs::path& path, std::string_view content) {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.valid()) {
    return fail(creation_error(), "{}: can't create: {}", path.string(), system_reason());
  }
  if (write_all(file.get(), content)) return {};
  return fail(ErrorKind::io, "{}: can't write {} bytes: {}", path.string(), content.size(),
              system_reason());
}

}  // namespace waymark
