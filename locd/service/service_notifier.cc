#include "locd/service/service_notifier.h"

#include <fmt/format.h>
#include <systemd/sd-daemon.h>

namespace waymark {

ServiceNotifier::ServiceNotifier() {
  std::uint64_t period_us = 0;
  if (::sd_watchdog_enabled(0, &period_us) > 0) {
    watchdog_period_ = std::chrono::microseconds(period_us);
  }
}

void ServiceNotifier::ready(const std::string& status) {
  last_status_ = status;
  ::sd_notify(0, fmt::format("READY=1\nSTATUS={}", status).c_str());
}

void ServiceNotifier::status(const std::string& status) {
  if (status == last_status_) return;
  last_status_ = status;
  ::sd_notify(0, fmt::format("STATUS={}", status).c_str());
}

void ServiceNotifier::reloading(Stamp now) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  ::sd_notify(0, fmt::format("RELOADING=1\nMONOTONIC_USEC={}", us).c_str());
}

void ServiceNotifier::stopping() { ::sd_notify(0, "STOPPING=1"); }

void ServiceNotifier::extend_start(Stamp now) {
  constexpr Stamp kEvery = std::chrono::seconds(2);
  if (now - last_extended_ < kEvery) return;
  last_extended_ = now;
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(5 * kEvery).count();
  ::sd_notify(0, fmt::format("EXTEND_TIMEOUT_USEC={}", us).c_str());
}

void ServiceNotifier::feed_watchdog(Stamp now) {
  if (!watchdog_period_ || now - last_fed_ < *watchdog_period_ / 4) return;
  last_fed_ = now;
  ::sd_notify(0, "WATCHDOG=1");
}

}  // namespace waymark
