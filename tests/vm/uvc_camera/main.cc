// A USB video camera for a virtual machine: a capture's images over usbredir, until the machine
// ends or the process is ended, which unplugs it.
#include <poll.h>

#include <CLI/CLI.hpp>

#include "drivers/monotonic_clock.h"
#include "locd/service/control_socket.h"
#include "tests/vm/uvc_camera/usb_link.h"

namespace {

using namespace waymark;
using namespace waymark::uvc;

struct Options {
  std::string socket;
  std::string control;
  std::string folder;
  std::string serial = "0";
  double fps = 1;
  bool mjpeg = false;
};

Status run(const Options& options) {
  auto feed =
      read_frame_feed(options.folder, options.mjpeg ? PixelFormat::mjpeg : PixelFormat::grey);
  if (!feed) return tl::make_unexpected(feed.error());
  feed->format.fps = options.fps;
  feed->format.serial = options.serial;
  UvcDevice device(std::move(*feed));
  auto orders = ControlSocket::open(options.control);
  if (!orders) return tl::make_unexpected(orders.error());
  auto link = UsbLink::accept(options.socket, device);
  if (!link) return tl::make_unexpected(link.error());
  const auto obey = [&](std::string_view order) -> ControlSocket::Answer {
    return [answer = device.obey(order)](Stamp) { return answer; };
  };
  while ((*link)->serve(monotonic_now())) {
    orders->serve(obey, monotonic_now());
    // Orders of a client that is connected already are looked for every 50 ms.
    int wait_ms = 50;
    if (const auto due = (*link)->due()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(*due - monotonic_now());
      wait_ms = std::clamp(static_cast<int>(left.count()), 0, wait_ms);
    }
    pollfd watched[] = {{(*link)->descriptor(), POLLIN, 0}, {orders->descriptor(), POLLIN, 0}};
    ::poll(watched, 2, wait_ms);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"A USB video camera that shows a capture's images to a virtual machine"};
  app.add_option("--socket", options.socket, "Unix socket where QEMU's usb-redir connects")
      ->required();
  app.add_option("--control", options.control,
                 "Unix socket for orders: stall, freeze, mute, short N, paint GREY, go, status")
      ->required();
  app.add_option("--images", options.folder, "Folder with one camera's images")->required();
  app.add_option("--serial", options.serial, "Serial number");
  app.add_option("--fps", options.fps, "Frames per second")->check(CLI::Range(0.1, 120.0));
  app.add_flag("--mjpeg", options.mjpeg, "Send JPEG files as they are, not grey pixels");
  CLI11_PARSE(app, argc, argv);
  if (const Status done = run(options); !done) {
    fmt::print(stderr, "uvc_camera: {}\n", done.error().message);
    return done.error().exit_code();
  }
  return 0;
}
