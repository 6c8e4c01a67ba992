#pragma once

#include <usbredirparser.h>

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/base/descriptor.h"
#include "core/base/error.h"
#include "tests/vm/uvc_camera/uvc_device.h"

namespace waymark::uvc {

/// Brings a camera to a virtual machine over the usbredir protocol: QEMU's usb-redir device at the
/// other end of a unix socket. The camera is plugged in as long as the link lives.
class UsbLink {
 public:
  /// Listens at `path` and waits for QEMU. Errors: cant_create, permission, io.
  [[nodiscard]] static Expected<std::unique_ptr<UsbLink>> accept(const std::filesystem::path& path,
                                                                 UvcDevice& device);
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  /// Readable when the host has asked for something.
  [[nodiscard]] int descriptor() const { return socket_.get(); }
  /// When serve has something to do though the host is silent; nullopt: never.
  [[nodiscard]] std::optional<Instant> due() const;
  /// Takes what the host asks for, sends what is due; false when the host has hung up.
  [[nodiscard]] bool serve(Instant now);

 private:
  struct PendingTransfer {
    std::uint64_t id;
    usb_redir_bulk_packet_header header;
  };
  UsbLink(Descriptor socket, UvcDevice& device);
  void set_callbacks();
  void send_interfaces();
  void connect_device();
  void answer(std::uint64_t id, usb_redir_control_packet_header header, Bytes data);
  void cancel(std::uint64_t id);
  void send_payloads(Instant now);
  [[nodiscard]] bool flush();

  Descriptor socket_;
  UvcDevice& device_;
  std::unique_ptr<usbredirparser, void (*)(usbredirparser*)> parser_;
  std::deque<PendingTransfer> pending_;  ///< the host's, for images
  Instant now_{0};                       ///< as serve was told
};

}  // namespace waymark::uvc
