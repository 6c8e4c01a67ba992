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
#include "core/base/input_file.h"
#include "core/base/same_file.h"
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
TemporaryFile create_beside(const fs::path& path, mode_t mode) {
  TemporaryFile temporary;
  do {
    std::uint64_t unique = 0;
    if (::getrandom(&unique, sizeof unique, 0) != sizeof unique) break;
    temporary.path = path;
    // A name may have 255 bytes.
    const std::string name = path.filename().string().substr(0, 200);
    temporary.path.replace_filename(fmt::format(".{}.{:016x}", name, unique));
    temporary.file =
        Descriptor(::open(temporary.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  } while (!temporary.file.valid() && errno == EEXIST);
  return temporary;
}

}  // namespace

Status write_file_atomically(const fs::path& named, std::string_view content) {
  const auto behind = behind_links(named);
  if (!behind) {
    return fail(ErrorKind::cant_create, "{}: can't write: links that lead in circles; name a file",
                named.string());
  }
  const fs::path& path = *behind;
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return fail(ErrorKind::cant_create, "{}: can't write: it is {}; name a file", path.string(),
                fs::is_directory(status) ? "a folder" : "no regular file");
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  // What was there keeps its mode; the process's mask is for new files alone.
  const bool replaces = fs::is_regular_file(status);
  const mode_t mode = replaces ? static_cast<mode_t>(status.permissions()) & 0777U : 0666U;
  const auto [temporary, file] = create_beside(path, mode);
  if (!file.valid()) {
    return fail(creation_error(),
                "{}: can't create: {}; check that the folder {} exists and is writable",
                path.string(), system_reason(), folder.string());
  }
  const auto give_up = [&, &name = temporary]() -> Status {
    const std::string why = system_reason();
    ::unlink(name.c_str());
    return fail(ErrorKind::io, "{}: can't write {} bytes: {}; the earlier content is unchanged",
                path.string(), content.size(), why);
  };
  if (replaces) (void)::fchmod(file.get(), mode);  // not on every file system; then it is narrower
  if (!write_all(file.get(), content)) return give_up();
  if (::fsync(file.get()) != 0) return give_up();
  if (::rename(temporary.c_str(), path.c_str()) != 0) return give_up();
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.valid()) ::fsync(directory.get());
  return {};
}

Expected<std::string> read_file(const fs::path& path, std::size_t max_bytes) {
  auto file = InputFile::open(path, max_bytes);
  if (!file) return tl::make_unexpected(file.error());
  std::string content;
  content.reserve(file->size());
  std::array<char, 65536> buffer{};
  for (;;) {
    const auto got = file->read(buffer);
    if (!got) return tl::make_unexpected(got.error());
    content.append(buffer.data(), *got);
    if (*got < buffer.size()) return content;
  }
}

}  // namespace waymark
