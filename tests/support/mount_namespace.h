#pragma once

#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <utility>

namespace waymark::test {

/// From now on what this process mounts is seen by it alone. False where the system does not permit
/// that. To be called before the process has threads.
[[nodiscard]] inline bool enter_mount_namespace() {
  const uid_t user = ::geteuid();
  // Mounting is for root; anybody is root of a user namespace of his own.
  if (::unshare(user == 0 ? CLONE_NEWNS : CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  if (user != 0) std::ofstream("/proc/self/uid_map") << user << " " << user << " 1";
  return ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
}

/// What lies at `from` lies at `to` as well, until the end of its scope.
class BindMount {
 public:
  BindMount(const std::filesystem::path& from, std::filesystem::path to) : to_(std::move(to)) {
    is_there_ = ::mount(from.c_str(), to_.c_str(), nullptr, MS_BIND, nullptr) == 0;
  }
  BindMount(BindMount&& other) noexcept : to_(std::move(other.to_)), is_there_(other.is_there_) {
    other.is_there_ = false;
  }
  BindMount& operator=(BindMount&&) = delete;
  BindMount(const BindMount&) = delete;
  BindMount& operator=(const BindMount&) = delete;
  ~BindMount() {
    if (is_there_) ::umount2(to_.c_str(), MNT_DETACH);
  }
  [[nodiscard]] bool is_there() const { return is_there_; }
  [[nodiscard]] const std::filesystem::path& place() const { return to_; }

 private:
  std::filesystem::path to_;
  bool is_there_ = false;
};

}  // namespace waymark::test
