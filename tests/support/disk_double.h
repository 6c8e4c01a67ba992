#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>

#include "core/geometry/stamp.h"

namespace waymark::test {

/// The disk as a test wants it: slow, or full. While one lives, fsync, fdatasync, fdopendir and
/// fstatvfs of the whole executable (which disk_double.cc must be linked into) go through it;
/// otherwise they are the system's.
class DiskDouble {
 public:
  DiskDouble();
  /// The disk answers again.
  ~DiskDouble();
  DiskDouble(const DiskDouble&) = delete;
  DiskDouble& operator=(const DiskDouble&) = delete;

  /// From now on whoever brings data to the disk waits for release().
  void stall();
  /// From now on whoever lists a folder of that name does.
  void stall_listing(const std::string& folder_name);
  void release();
  /// From now on nothing is brought to the disk, and that at once.
  void bring_nothing() { brings_nothing_ = true; }
  [[nodiscard]] bool brings_nothing() const { return brings_nothing_; }
  /// Waits until somebody waits for the disk; false when nobody does by `deadline`.
  [[nodiscard]] bool holds_somebody(Stamp deadline);

  /// Files that were brought to the disk.
  [[nodiscard]] std::set<std::string> synced() const;

  /// What fstatvfs is to say (bytes).
  void say_free(std::function<std::uint64_t()> free_bytes) { free_bytes_ = std::move(free_bytes); }
  [[nodiscard]] const std::function<std::uint64_t()>& free_bytes() const { return free_bytes_; }

  /// Of the executable's fsync and fdatasync.
  void bring(int descriptor);
  /// Of its fdopendir.
  void list(int descriptor);

 private:
  void hold(std::unique_lock<std::mutex>& lock, const bool& while_true);
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> brings_nothing_{false};
  bool stalls_ = false;
  bool listing_stalls_ = false;
  std::string stalled_folder_;
  int waiting_ = 0;
  std::set<std::string> synced_;
  std::function<std::uint64_t()> free_bytes_;
};

}  // namespace waymark::test
