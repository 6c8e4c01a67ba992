#include "locd/service/service_notifier.h"

#include <fmt/format.h>
#include <systemd/sd-daemon.h>

#include "core/base/one_line.h"

namespace waymark {

ServiceNotifier::ServiceNotifier() {
  std::uint64_t period_us = 0;
  if (::sd_watchdog_enabled(0, &period_us) > 0) {
    watchdog_period_ = std::chrono::microseconds(period_us);
  }
}

void ServiceNotifier::ready(const std::string& status) {
  this->status(status);
  // A datagram of its own: whatever becomes of the text's, this one is heard.
  socket_.tell("READY=1");
}

void ServiceNotifier::status(const std::string& status) {
  // Every line of a datagram is an order to systemd.
  const std::string line = in_one_line(status);
  if (line == last_status_) return;
  // One that systemd has not heard is told with the next look.
  if (socket_.offer(fmt::format("STATUS={}", line))) last_status_ = line;
}

void ServiceNotifier::reloading(Stamp now) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  socket_.tell(fmt::format("RELOADING=1\nMONOTONIC_USEC={}", us));
}

void ServiceNotifier::stopping() { socket_.tell("STOPPING=1"); }

void ServiceNotifier::extend_start(Stamp now) {
  constexpr Stamp kEvery = std::chrono::seconds(2);
  if (now - last_extended_ < kEvery) return;
  last_extended_ = now;
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(5 * kEvery).count();
  socket_.tell(fmt::format("EXTEND_TIMEOUT_USEC={}", us));
}

void ServiceNotifier::feed_watchdog(Stamp now) {
  if (!watchdog_period_ || now - last_fed_ < *watchdog_period_ / 4) return;
  if (socket_.offer("WATCHDOG=1")) last_fed_ = now;
}

}  // namespace waymark
