#include "core/base/atomic_file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "core/base/descriptor.h"
#include "core/base/system_call.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

struct TemporaryFile {
  fs::path path;
  Descriptor file;  ///< invalid, with errno, when it can't be created
};

/// Beside `path`, hidden. Not mkstemp, whose files are their owner's alone: the process's mask,
/// which can only be read by changing it for every thread, is applied by open itself.
TemporaryFile create_beside(const fs::path& path) {
  TemporaryFile temporary;
  do {
    std::uint64_t unique = 0;
    if (::getrandom(&unique, sizeof unique, 0) != sizeof unique) break;
    temporary.path = path;
    temporary.path.replace_filename(fmt::format(".{}.{:016x}", path.filename().string(), unique));
    temporary.file =
        Descriptor(::open(temporary.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  } while (!temporary.file.valid() && errno == EEXIST);
  return temporary;
}

}  // namespace

Status write_file_atomically(const fs::path& named, std::string_view content) {
  std::error_code ignored;
  // A link stays a link: the file behind it is what is replaced.
  const fs::path path = fs::is_symlink(named, ignored) ? fs::weakly_canonical(named) : named;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return fail(ErrorKind::cant_create, "{}: can't write: it is {}; name a file", path.string(),
                fs::is_directory(status) ? "a folder" : "no regular file");
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const auto [temporary, file] = create_beside(path);
  if (!file.valid()) {
    return fail(creation_error(),
                "{}: can't create: {}; check that the folder {} exists and is writable",
                path.string(), system_reason(), folder.string());
  }
  const auto give_up = [&]() -> Status {
    const std::string why = system_reason();
    ::unlink(temporary.c_str());
    return fail(ErrorKind::io, "{}: can't write {} bytes: {}; the earlier content is unchanged",
                path.string(), content.size(), why);
  };
  if (!write_all(file.get(), content)) return give_up();
  if (::fsync(file.get()) != 0) return give_up();
  if (::rename(temporary.c_str(), path.c_str()) != 0) return give_up();
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.valid()) ::fsync(directory.get());
  return {};
}

Expected<std::string> read_file(const fs::path& path, std::size_t max_bytes) {
  // Without waiting for whoever may write to what turns out to be a pipe.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.valid()) {
    const bool denied = errno == EACCES || errno == EPERM;
    return fail(denied ? ErrorKind::permission : ErrorKind::no_input, "{}: can't open: {}",
                path.string(), system_reason());
  }
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return fail(ErrorKind::no_input, "{}: can't read: it is {}; name a file", path.string(),
                S_ISDIR(status.st_mode) ? "a folder" : "no regular file");
  }
  const auto too_large = [&] {
    return fail(ErrorKind::bad_data, "{}: larger than {} bytes; this is not such a file",
                path.string(), max_bytes);
  };
  if (static_cast<std::uintmax_t>(status.st_size) > max_bytes) return too_large();
  std::string content;
  std::array<char, 65536> buffer{};
  for (;;) {
    const ssize_t got = ::read(file.get(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(ErrorKind::io, "{}: can't read: {}", path.string(), system_reason());
    if (got == 0) return content;
    content.append(buffer.data(), static_cast<std::size_t>(got));
    if (content.size() > max_bytes) return too_large();  // it has grown since
  }
}

}  // namespace waymark
