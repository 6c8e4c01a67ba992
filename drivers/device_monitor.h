#pragma once

#include <memory>

#include "core/base/error.h"

namespace waymark {

/// Listens for video devices that are plugged in: udev announces them once their links and
/// permissions are set.
class DeviceMonitor {
 public:
  /// unavailable where the system gives no such announcements.
  [[nodiscard]] static Expected<DeviceMonitor> open();

  /// Readable when there may be an announcement.
  [[nodiscard]] int descriptor() const;

  /// Whether a video device has come since the last call. Never waits. unavailable when the system
  /// fails to tell: the descriptor may then stay readable, so close the monitor.
  [[nodiscard]] Expected<bool> device_came();

 private:
  struct Parts;
  struct Closer {
    void operator()(Parts* parts) const;
  };
  std::unique_ptr<Parts, Closer> parts_;
};

}  // namespace waymark
