#include "locd/service/instance_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "core/base/system_call.h"
#include "core/base/text_field.h"

namespace waymark {
namespace {

/// Neither what a link leads to, nor waiting for who opens the other end of a pipe.
constexpr int kOwnFile = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;

/// What the holder wrote: its pid.
std::string pid_in(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t got = ::pread(descriptor, text.data(), text.size() - 1, 0);
  std::string pid(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  while (!pid.empty() && pid.back() == '\n') pid.pop_back();
  return pid.empty() ? "unknown" : pid;
}

/// What an open file is that is not written, as it is none of our own; empty where it is.
std::string why_not_own(int descriptor) {
  struct stat facts {};
  if (::fstat(descriptor, &facts) != 0) return system_reason();
  if (!S_ISREG(facts.st_mode)) return "it is no regular file";
  if (facts.st_nlink != 1) return fmt::format("it has {} names", facts.st_nlink);
  return {};
}

/// Of the whole file, held by the open file: it ends when the last descriptor of it does.
struct flock write_lock() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

}  // namespace

Expected<InstanceLock> InstanceLock::take(const std::filesystem::path& file) {
  std::error_code ignored;  // the open below says what is wrong
  std::filesystem::create_directories(file.parent_path(), ignored);
  Descriptor opened(::open(file.c_str(), O_RDWR | O_CREAT | kOwnFile, 0644));
  if (!opened.valid() && errno == ELOOP) {
    return fail(ErrorKind::cant_create, "{}: can't lock: it is a link; remove it", file.string());
  }
  if (!opened.valid()) {
    return fail(
        creation_error(),
        "{}: can't create: {}; systemctl start locd runs it as the service; by hand, it needs a "
        "RUNTIME_DIRECTORY and a STATE_DIRECTORY of its own",
        file.string(), system_reason());
  }
  if (const std::string why = why_not_own(opened.get()); !why.empty()) {
    return fail(ErrorKind::cant_create, "{}: can't lock: {}; remove it", file.string(), why);
  }
  struct flock whole = write_lock();
  if (::fcntl(opened.get(), F_OFD_SETLK, &whole) != 0) {
    return fail(ErrorKind::unavailable,
                "{}: another locd is running, with pid {}; stop it before starting another",
                file.string(), pid_in(opened.get()));
  }
  const std::string pid = std::to_string(::getpid()) + "\n";
  if (::ftruncate(opened.get(), 0) != 0 ||
      ::pwrite(opened.get(), pid.data(), pid.size(), 0) != static_cast<ssize_t>(pid.size())) {
    return fail(ErrorKind::io, "{}: can't write: {}", file.string(), system_reason());
  }
  return InstanceLock(std::move(opened));
}

std::optional<int> InstanceLock::holder(const std::filesystem::path& file) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | kOwnFile));
  // Asked without locking: a lock of ours, however short, would refuse a locd that just starts.
  struct flock held = write_lock();
  if (!opened.valid() || ::fcntl(opened.get(), F_OFD_GETLK, &held) != 0) return std::nullopt;
  if (held.l_type == F_UNLCK) return std::nullopt;
  return parse_whole<int>(pid_in(opened.get()));
}

}  // namespace waymark
