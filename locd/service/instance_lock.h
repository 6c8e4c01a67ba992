#pragma once

#include <filesystem>
#include <optional>

#include "core/base/descriptor.h"
#include "core/base/error.h"

namespace waymark {

/// A file lock, held while this process is the one locd of a folder. The kernel releases it
/// however the process ends.
class InstanceLock {
 public:
  /// Takes `file` (created where absent, with its folder). Errors: unavailable, naming the pid of
  /// the process that holds it; permission and cant_create when the file can't be made; cant_create
  /// where it is a link, no regular file, or one with several names: nothing of it is changed.
  [[nodiscard]] static Expected<InstanceLock> take(const std::filesystem::path& file);

  /// The pid of the process that holds `file`; nullopt: none, or none that we may see.
  [[nodiscard]] static std::optional<int> holder(const std::filesystem::path& file);

 private:
  explicit InstanceLock(Descriptor file) : file_(std::move(file)) {}
  Descriptor file_;
};

}  // namespace waymark
