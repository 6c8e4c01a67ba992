#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "core/base/check.h"
#include "core/base/descriptor.h"

namespace waymark {

/// Ends another thread's poll(): readable from raise() to clear().
class Interrupt {
 public:
  Interrupt() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) { WAYMARK_CHECK(event_.valid()); }

  void raise() {
    const std::uint64_t one = 1;
    // Can only fail when it stands at its maximum, which is raised.
    [[maybe_unused]] const ssize_t written = ::write(event_.get(), &one, sizeof one);
  }
  /// Whether it was raised.
  bool clear() {
    std::uint64_t count = 0;
    return ::read(event_.get(), &count, sizeof count) == sizeof count;
  }
  [[nodiscard]] int descriptor() const { return event_.get(); }

 private:
  Descriptor event_;
};

}  // namespace waymark
