#pragma once

#include <optional>
#include <string>

#include "core/geometry/stamp.h"
#include "locd/service/notify_socket.h"

namespace waymark {

/// Tells systemd how the service is (NotifySocket). Without systemd nothing happens. Texts go out
/// by the rule of in_one_line, whatever they quote.
class ServiceNotifier {
 public:
  ServiceNotifier();

  void ready(const std::string& status);
  void status(const std::string& status);
  /// A reload begins; ready() ends it.
  void reloading(Stamp now);
  void stopping();
  /// Not ready yet, but on the way: to be called often until ready.
  void extend_start(Stamp now);
  /// To be called often, and only while every thread makes progress. A message goes to systemd
  /// four times per watchdog period.
  void feed_watchdog(Stamp now);

 private:
  NotifySocket socket_;
  std::string last_status_;
  std::optional<Stamp> watchdog_period_;
  Stamp last_fed_{0};
  Stamp last_extended_{0};
};

}  // namespace waymark
