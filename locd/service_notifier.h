#pragma once

#include <optional>
#include <string>

#include "core/geometry/stamp.h"

namespace waymark {

/// Tells systemd how the service is (sd_notify). Without systemd nothing happens.
class ServiceNotifier {
 public:
  ServiceNotifier();

  void ready(const std::string& status);
  void status(const std::string& status);
  /// A reload begins; ready() ends it.
  void reloading(Stamp now);
  void stopping();
  /// Still alive: to be called only while everything turns.
  void feed_watchdog();
  /// Within which the watchdog must be fed; nullopt: there is none.
  [[nodiscard]] std::optional<Stamp> watchdog_period() const { return watchdog_period_; }

 private:
  std::string last_status_;
  std::optional<Stamp> watchdog_period_;
};

}  // namespace waymark
