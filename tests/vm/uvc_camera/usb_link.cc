#include "tests/vm/uvc_camera/usb_link.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/base/system_call.h"
#include "tests/vm/uvc_camera/usb_descriptors.h"

namespace waymark::uvc {
namespace {

UsbLink& link_of(void* context) { return *static_cast<UsbLink*>(context); }

/// usbredir numbers endpoints 0 to 15 towards the device and 16 to 31 towards the host.
constexpr std::size_t endpoint_slot(std::uint8_t address) {
  return (address & 0x0FU) + ((address & 0x80U) != 0 ? 16U : 0U);
}

std::uint32_t length_of(const usb_redir_bulk_packet_header& header) {
  return header.length | static_cast<std::uint32_t>(header.length_high) << 16U;
}

void set_length(usb_redir_bulk_packet_header& header, std::size_t bytes) {
  header.length = static_cast<std::uint16_t>(bytes);
  header.length_high = static_cast<std::uint16_t>(bytes >> 16U);
}

}  // namespace

Expected<std::unique_ptr<UsbLink>> UsbLink::accept(const std::filesystem::path& path,
                                                   UvcDevice& device) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof address.sun_path) {
    return fail(ErrorKind::cant_create, "{}: too long for a socket's name", name);
  }
  std::copy(name.begin(), name.end(), std::begin(address.sun_path));
  ::unlink(name.c_str());
  const Descriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener.get(), 1) != 0) {
    return fail(creation_error(), "{}: {}", name, system_reason());
  }
  Descriptor socket(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!socket.valid()) return fail(ErrorKind::io, "{}: {}", name, system_reason());
  return std::unique_ptr<UsbLink>(new UsbLink(std::move(socket), device));
}

UsbLink::UsbLink(Descriptor socket, UvcDevice& device)
    : socket_(std::move(socket)),
      device_(device),
      parser_(usbredirparser_create(), usbredirparser_destroy) {
  set_callbacks();
  std::array<std::uint32_t, USB_REDIR_CAPS_SIZE> capabilities{};
  for (const int capability :
       {usb_redir_cap_connect_device_version, usb_redir_cap_ep_info_max_packet_size,
        usb_redir_cap_64bits_ids, usb_redir_cap_32bits_bulk_length}) {
    usbredirparser_caps_set_cap(capabilities.data(), capability);
  }
  usbredirparser_init(parser_.get(), "waymark uvc_camera", capabilities.data(),
                      static_cast<int>(capabilities.size()), usbredirparser_fl_usb_host);
}

void UsbLink::set_callbacks() {
  usbredirparser& p = *parser_;
  p.priv = this;
  p.log_func = [](void*, int level, const char* message) {
    if (level <= usbredirparser_warning) fmt::print(stderr, "usbredir: {}\n", message);
  };
  p.read_func = [](void* context, std::uint8_t* data, int size) {
    const auto got = ::read(link_of(context).socket_.get(), data, static_cast<std::size_t>(size));
    if (got < 0) return errno == EAGAIN ? 0 : -1;
    return got == 0 ? -1 : static_cast<int>(got);
  };
  p.write_func = [](void* context, std::uint8_t* data, int size) {
    const auto put =
        ::send(link_of(context).socket_.get(), data, static_cast<std::size_t>(size), MSG_NOSIGNAL);
    if (put < 0) return errno == EAGAIN ? 0 : -1;
    return static_cast<int>(put);
  };
  p.hello_func = [](void* context, usb_redir_hello_header*) { link_of(context).connect_device(); };
  p.reset_func = [](void* context) {
    link_of(context).device_.reset();
    link_of(context).pending_.clear();
  };
  p.set_configuration_func = [](void* context, std::uint64_t id,
                                usb_redir_set_configuration_header* header) {
    link_of(context).send_interfaces();
    usb_redir_configuration_status_header done{usb_redir_success, header->configuration};
    usbredirparser_send_configuration_status(link_of(context).parser_.get(), id, &done);
  };
  p.get_configuration_func = [](void* context, std::uint64_t id) {
    usb_redir_configuration_status_header is{usb_redir_success, 1};
    usbredirparser_send_configuration_status(link_of(context).parser_.get(), id, &is);
  };
  p.set_alt_setting_func = [](void* context, std::uint64_t id,
                              usb_redir_set_alt_setting_header* header) {
    link_of(context).device_.reset();
    link_of(context).send_interfaces();
    usb_redir_alt_setting_status_header done{usb_redir_success, header->interface, header->alt};
    usbredirparser_send_alt_setting_status(link_of(context).parser_.get(), id, &done);
  };
  p.get_alt_setting_func = [](void* context, std::uint64_t id,
                              usb_redir_get_alt_setting_header* header) {
    usb_redir_alt_setting_status_header is{usb_redir_success, header->interface, 0};
    usbredirparser_send_alt_setting_status(link_of(context).parser_.get(), id, &is);
  };
  p.control_packet_func = [](void* context, std::uint64_t id,
                             usb_redir_control_packet_header* header, std::uint8_t* data,
                             int size) {
    UsbLink& link = link_of(context);
    link.answer(id, *header, data == nullptr ? Bytes{} : Bytes(data, data + size));
    usbredirparser_free_packet_data(link.parser_.get(), data);
  };
  p.bulk_packet_func = [](void* context, std::uint64_t id, usb_redir_bulk_packet_header* header,
                          std::uint8_t* data, int) {
    link_of(context).pending_.push_back({id, *header});
    usbredirparser_free_packet_data(link_of(context).parser_.get(), data);
  };
  p.cancel_data_packet_func = [](void* context, std::uint64_t id) { link_of(context).cancel(id); };
  // The library calls these without looking whether they are there.
  p.filter_filter_func = [](void*, usbredirfilter_rule* rules, int) { std::free(rules); };
  p.filter_reject_func = [](void*) { fmt::print(stderr, "QEMU's filter refuses the camera\n"); };
  p.device_disconnect_ack_func = [](void*) {};
}

void UsbLink::send_interfaces() {
  usb_redir_interface_info_header interfaces{};
  interfaces.interface_count = 2;
  for (const std::uint8_t i : {kControlInterface, kStreamInterface}) {
    interfaces.interface[i] = i;
    interfaces.interface_class[i] = kVideoClass;
    interfaces.interface_subclass[i] = static_cast<std::uint8_t>(i + 1);
  }
  usbredirparser_send_interface_info(parser_.get(), &interfaces);

  usb_redir_ep_info_header endpoints{};
  std::fill(std::begin(endpoints.type), std::end(endpoints.type), usb_redir_type_invalid);
  for (const std::uint8_t control : {0x00, 0x80}) {
    endpoints.type[endpoint_slot(control)] = usb_redir_type_control;
    endpoints.max_packet_size[endpoint_slot(control)] = 64;
  }
  endpoints.type[endpoint_slot(kStreamEndpoint)] = usb_redir_type_bulk;
  endpoints.interface[endpoint_slot(kStreamEndpoint)] = kStreamInterface;
  endpoints.max_packet_size[endpoint_slot(kStreamEndpoint)] = kBulkPacketBytes;
  usbredirparser_send_ep_info(parser_.get(), &endpoints);
}

void UsbLink::connect_device() {
  send_interfaces();
  usb_redir_device_connect_header device{};
  device.speed = usb_redir_speed_high;
  device.device_class = 0xEF;
  device.device_subclass = 2;
  device.device_protocol = 1;
  device.vendor_id = kVendor;
  device.product_id = kProduct;
  device.device_version_bcd = kRelease;
  usbredirparser_send_device_connect(parser_.get(), &device);
}

void UsbLink::answer(std::uint64_t id, usb_redir_control_packet_header header, Bytes data) {
  if (device_.mute()) return;
  const ControlRequest request{header.requesttype, header.request, header.value,
                               header.index,       header.length,  std::move(data)};
  auto bytes = device_.answer(request, now_);
  header.status = bytes ? usb_redir_success : usb_redir_stall;
  if (!bytes || !request.to_host()) {
    header.length = bytes ? static_cast<std::uint16_t>(request.data.size()) : std::uint16_t{0};
    usbredirparser_send_control_packet(parser_.get(), id, &header, nullptr, 0);
    return;
  }
  header.length = static_cast<std::uint16_t>(bytes->size());
  usbredirparser_send_control_packet(parser_.get(), id, &header, bytes->data(), header.length);
}

void UsbLink::cancel(std::uint64_t id) {
  const auto found = std::find_if(pending_.begin(), pending_.end(),
                                  [&](const PendingTransfer& p) { return p.id == id; });
  if (found == pending_.end()) return;
  usb_redir_bulk_packet_header header = found->header;
  pending_.erase(found);
  header.status = usb_redir_cancelled;
  set_length(header, 0);
  usbredirparser_send_bulk_packet(parser_.get(), id, &header, nullptr, 0);
}

void UsbLink::send_payloads(Instant now) {
  while (!pending_.empty()) {
    auto payload = device_.stream().next_payload(now, length_of(pending_.front().header));
    if (!payload) return;
    auto [id, header] = pending_.front();
    pending_.pop_front();
    header.status = usb_redir_success;
    set_length(header, payload->size());
    usbredirparser_send_bulk_packet(parser_.get(), id, &header, payload->data(),
                                    static_cast<int>(payload->size()));
  }
}

bool UsbLink::flush() {
  while (usbredirparser_has_data_to_write(parser_.get()) > 0) {
    if (usbredirparser_do_write(parser_.get()) < 0) return false;
    pollfd writable{socket_.get(), POLLOUT, 0};
    ::poll(&writable, 1, -1);
  }
  return true;
}

std::optional<Instant> UsbLink::due() const {
  if (pending_.empty()) return std::nullopt;
  return device_.stream().due();
}

bool UsbLink::serve(Instant now) {
  now_ = now;
  if (usbredirparser_do_read(parser_.get()) == usbredirparser_read_io_error) return false;
  send_payloads(now);
  return flush();
}

}  // namespace waymark::uvc
