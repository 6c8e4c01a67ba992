#include "tests/support/disk_double.h"

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
  if (DiskDouble* const disk = in_place.load()) disk->bring(descriptor);
  return static_cast<int>(::syscall(call, descriptor));
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

void DiskDouble::release() {
  const std::lock_guard lock(mutex_);
  stalls_ = false;
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
  std::error_code ignored;
  const auto file =
      std::filesystem::read_symlink(fmt::format("/proc/self/fd/{}", descriptor), ignored);
  std::unique_lock lock(mutex_);
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, [&] { return !stalls_; });
  --waiting_;
  synced_.insert(file.string());
  changed_.notify_all();
}

}  // namespace waymark::test

// In place of the C library's, in this executable.
extern "C" int fsync(int descriptor) { return waymark::test::bring_by(SYS_fsync, descriptor); }

extern "C" int fdatasync(int descriptor) {
  return waymark::test::bring_by(SYS_fdatasync, descriptor);
}

extern "C" int statvfs(const char* path, struct statvfs* disk) noexcept {
  using Statvfs = int (*)(const char*, struct statvfs*);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym gives
  static const auto system = reinterpret_cast<Statvfs>(::dlsym(RTLD_NEXT, "statvfs"));
  const int failed = system(path, disk);
  const waymark::test::DiskDouble* const test = waymark::test::in_place.load();
  if (failed == 0 && test != nullptr && test->free_bytes()) {
    disk->f_bavail = test->free_bytes()() / disk->f_frsize;
  }
  return failed;
}
