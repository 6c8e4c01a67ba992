#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <string>

#include "core/base/descriptor.h"

namespace waymark {

/// Where systemd listens to the service (NOTIFY_SOCKET). sd_notify opens a socket for every
/// message: one that is kept is there also when no descriptor is left, and need not wait. Without
/// systemd nothing happens.
class NotifySocket {
 public:
  NotifySocket();

  /// What must be heard: waits where systemd is behind.
  void tell(const std::string& message) const { (void)send(message, 0); }
  /// What can be said again; false: systemd is behind, and has not heard it.
  [[nodiscard]] bool offer(const std::string& message) const { return send(message, MSG_DONTWAIT); }

 private:
  [[nodiscard]] bool send(const std::string& message, int flags) const;

  sockaddr_un address_{};
  socklen_t address_size_ = 0;  ///< 0: there is no systemd
  Descriptor socket_;
};

}  // namespace waymark
