#include "core/base/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/system_call.h"

namespace waymark {
namespace {

tl::unexpected<Error> too_large(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  return fail(ErrorKind::bad_data, "{}: larger than {} bytes; this is not such a file",
              path.string(), max_bytes);
}

/// File systems that compress have fewer blocks than bytes as well, but no holes.
bool is_sparse(int file, const struct stat& status) {
  constexpr std::intmax_t kBlock = 512;  // of st_blocks, whatever the file system's own
  constexpr std::intmax_t kMayBeMissing = std::intmax_t{1} << 20;
  if (status.st_blocks * kBlock + kMayBeMissing >= status.st_size) return false;
  const off_t hole = ::lseek(file, 0, SEEK_HOLE);
  ::lseek(file, 0, SEEK_SET);
  return hole >= 0 && hole < status.st_size;
}

}  // namespace

Expected<InputFile> InputFile::open(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  // Without waiting for whoever may write to what turns out to be a pipe.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
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
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  if (size > max_bytes) return too_large(path, max_bytes);
  if (is_sparse(file.get(), status)) {
    return fail(ErrorKind::bad_data,
                "{}: sparse: of its {} bytes most were never written; was it cut off while it was "
                "copied?",
                path.string(), size);
  }
  return InputFile(path, std::move(file), size, max_bytes);
}

Expected<std::size_t> InputFile::read(std::span<char> buffer) {
  std::size_t filled = 0;
  while (filled < buffer.size()) {
    const ssize_t got = ::read(file_.get(), buffer.data() + filled, buffer.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(ErrorKind::io, "{}: can't read: {}", path_.string(), system_reason());
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  taken_ += filled;
  if (taken_ > max_bytes_) return too_large(path_, max_bytes_);
  return filled;
}

}  // namespace waymark
