#pragma once

#include <filesystem>

#include "core/base/error.h"

namespace waymark {

/// Held while this process is the machine's locd. The kernel lets go of it however the process
/// ends.
class InstanceLock {
 public:
  /// Takes `file` (created where absent, with its folder). Errors: unavailable, naming the pid of
  /// the process that holds it; permission and cant_create when the file can't be made.
  [[nodiscard]] static Expected<InstanceLock> take(const std::filesystem::path& file);

  InstanceLock(InstanceLock&& other) noexcept : descriptor_(other.descriptor_) {
    other.descriptor_ = -1;
  }
  InstanceLock& operator=(InstanceLock&&) = delete;
  InstanceLock(const InstanceLock&) = delete;
  InstanceLock& operator=(const InstanceLock&) = delete;
  ~InstanceLock();

 private:
  explicit InstanceLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace waymark
