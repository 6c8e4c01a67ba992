#include "tests/support/disk_double.h"

#include <dirent.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>

#include "drivers/monotonic_clock.h"

namespace waymark::test {
namespace {

std::atomic<DiskDouble*> in_place{nullptr};

int bring_by(long call, int descriptor) {
  DiskDouble* const disk = in_place.load();
  if (disk != nullptr) disk->bring(descriptor);
  if (disk != nullptr && disk->brings_nothing()) return 0;
  return static_cast<int>(::syscall(call, descriptor));
}

std::filesystem::path path_of(int descriptor) {
  std::error_code ignored;
  return std::filesystem::read_symlink(fmt::format("/proc/self/fd/{}", descriptor), ignored);
}

}  // namespace

DiskDouble::DiskDouble() { in_place = this; }

DiskDouble::~DiskDouble() {
  release();
  in_place = nullptr;
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_ == 0; });
}

void DiskDouble::stall() {
  const std::lock_guard lock(mutex_);
  stalls_ = true;
}

void DiskDouble::stall_listing(const std::string& folder_name) {
  const std::lock_guard lock(mutex_);
  listing_stalls_ = true;
  stalled_folder_ = folder_name;
}

void DiskDouble::release() {
  const std::lock_guard lock(mutex_);
  stalls_ = listing_stalls_ = false;
  changed_.notify_all();
}

bool DiskDouble::holds_somebody(Stamp deadline) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, as_time_point(deadline), [&] { return waiting_ > 0; });
}

std::set<std::string> DiskDouble::synced() const {
  const std::lock_guard lock(mutex_);
  return synced_;
}

void DiskDouble::bring(int descriptor) {
  const std::string file = path_of(descriptor).string();
  std::unique_lock lock(mutex_);
  hold(lock, stalls_);
  synced_.insert(file);
}

void DiskDouble::list(int descriptor) {
  const std::string folder = path_of(descriptor).filename().string();
  std::unique_lock lock(mutex_);
  if (folder == stalled_folder_) hold(lock, listing_stalls_);
}

void DiskDouble::hold(std::unique_lock<std::mutex>& lock, const bool& while_true) {
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, [&] { return !while_true; });
  --waiting_;
  changed_.notify_all();
}

}  // namespace waymark::test

// In place of the C library's, in this executable.
extern "C" int fsync(int descriptor) { return waymark::test::bring_by(SYS_fsync, descriptor); }

extern "C" int fdatasync(int descriptor) {
  return waymark::test::bring_by(SYS_fdatasync, descriptor);
}

extern "C" int fstatvfs(int descriptor, struct statvfs* disk) noexcept {
  using Fstatvfs = int (*)(int, struct statvfs*);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym gives
  static const auto system = reinterpret_cast<Fstatvfs>(::dlsym(RTLD_NEXT, "fstatvfs"));
  const int failed = system(descriptor, disk);
  const waymark::test::DiskDouble* const test = waymark::test::in_place.load();
  if (failed == 0 && test != nullptr && test->free_bytes()) {
    disk->f_bavail = test->free_bytes()() / disk->f_frsize;
  }
  return failed;
}

extern "C" DIR* fdopendir(int descriptor) {
  using Fdopendir = DIR* (*)(int);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym gives
  static const auto system = reinterpret_cast<Fdopendir>(::dlsym(RTLD_NEXT, "fdopendir"));
  if (waymark::test::DiskDouble* const disk = waymark::test::in_place.load())
    disk->list(descriptor);
  return system(descriptor);
}
