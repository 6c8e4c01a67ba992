#include "locd/instance_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

namespace waymark {
namespace {

std::string reason() { return std::error_code(errno, std::generic_category()).message(); }

/// What the holder wrote: its pid.
std::string pid_in(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t got = ::pread(descriptor, text.data(), text.size() - 1, 0);
  std::string pid(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  while (!pid.empty() && pid.back() == '\n') pid.pop_back();
  return pid.empty() ? "unknown" : pid;
}

}  // namespace

Expected<InstanceLock> InstanceLock::take(const std::filesystem::path& file) {
  std::error_code ignored;  // the open below says what is wrong
  std::filesystem::create_directories(file.parent_path(), ignored);
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    const bool denied = errno == EACCES || errno == EPERM || errno == EROFS;
    return fail(denied ? ErrorKind::permission : ErrorKind::cant_create,
                "{}: can't create: {}; run as the service does, or set RUNTIME_DIRECTORY",
                file.string(), reason());
  }
  InstanceLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return fail(ErrorKind::unavailable,
                "{}: another locd is running, with pid {}; stop it before starting another",
                file.string(), pid_in(descriptor));
  }
  const std::string pid = std::to_string(::getpid()) + "\n";
  if (::ftruncate(descriptor, 0) != 0 ||
      ::pwrite(descriptor, pid.data(), pid.size(), 0) != static_cast<ssize_t>(pid.size())) {
    return fail(ErrorKind::io, "{}: can't write: {}", file.string(), reason());
  }
  return lock;
}

InstanceLock::~InstanceLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace waymark
