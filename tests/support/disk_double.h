#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>

#include "core/geometry/stamp.h"

namespace waymark::test {

/// The disk as a test wants it: slow, or full. While one lives, fsync, fdatasync and statvfs of the
/// whole executable (which disk_double.cc must be linked into) go through it; otherwise they are
/// the system's.
class DiskDouble {
 public:
  DiskDouble();
  /// The disk answers again.
  ~DiskDouble();
  DiskDouble(const DiskDouble&) = delete;
  DiskDouble& operator=(const DiskDouble&) = delete;

  /// From now on whoever brings data to the disk waits for release().
  void stall();
  void release();
  /// Waits until somebody waits for the disk; false when nobody does by `deadline`.
  [[nodiscard]] bool holds_somebody(Stamp deadline);

  /// Files that were brought to the disk.
  [[nodiscard]] std::set<std::string> synced() const;

  /// What statvfs is to say (bytes).
  void say_free(std::function<std::uint64_t()> free_bytes) { free_bytes_ = std::move(free_bytes); }
  [[nodiscard]] const std::function<std::uint64_t()>& free_bytes() const { return free_bytes_; }

  /// Of the executable's fsync and fdatasync.
  void bring(int descriptor);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stalls_ = false;
  int waiting_ = 0;
  std::set<std::string> synced_;
  std::function<std::uint64_t()> free_bytes_;
};

}  // namespace waymark::test
