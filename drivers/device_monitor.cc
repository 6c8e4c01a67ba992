#include "drivers/device_monitor.h"

#include <systemd/sd-device.h>
#include <systemd/sd-event.h>

#include <cstring>
#include <system_error>

namespace waymark {

namespace {

/// `failed`: minus an errno, as systemd's library says it.
tl::unexpected<Error> no_word(int failed) {
  return fail(ErrorKind::unavailable,
              "no word of devices that are plugged in: {}; those that are absent are tried for "
              "every few seconds",
              std::error_code(-failed, std::generic_category()).message());
}

}  // namespace

struct DeviceMonitor::Parts {
  sd_event* event = nullptr;
  sd_device_monitor* monitor = nullptr;
  bool came = false;

  static int hear(sd_device_monitor* /*monitor*/, sd_device* device, void* parts) {
    sd_device_action_t action = SD_DEVICE_REMOVE;
    if (::sd_device_get_action(device, &action) >= 0 && action != SD_DEVICE_REMOVE) {
      static_cast<Parts*>(parts)->came = true;
    }
    return 0;
  }
};

void DeviceMonitor::Closer::operator()(Parts* parts) const {
  ::sd_device_monitor_unref(parts->monitor);
  ::sd_event_unref(parts->event);
  std::default_delete<Parts>()(parts);
}

Expected<DeviceMonitor> DeviceMonitor::open() {
  DeviceMonitor opened;
  opened.parts_.reset(std::make_unique<Parts>().release());
  Parts& parts = *opened.parts_;
  int failed = ::sd_event_new(&parts.event);
  if (failed >= 0) failed = ::sd_device_monitor_new(&parts.monitor);
  if (failed >= 0) {
    failed = ::sd_device_monitor_filter_add_match_subsystem_devtype(parts.monitor, "video4linux",
                                                                    nullptr);
  }
  if (failed >= 0) failed = ::sd_device_monitor_attach_event(parts.monitor, parts.event);
  if (failed >= 0) failed = ::sd_device_monitor_start(parts.monitor, &Parts::hear, &parts);
  if (failed >= 0) return opened;
  return no_word(failed);
}

int DeviceMonitor::descriptor() const { return ::sd_event_get_fd(parts_->event); }

Expected<bool> DeviceMonitor::device_came() {
  parts_->came = false;
  int heard = 1;
  while (heard > 0) heard = ::sd_event_run(parts_->event, 0);
  if (heard < 0) return no_word(heard);
  return parts_->came;
}

}  // namespace waymark
