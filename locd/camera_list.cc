#include "locd/camera_list.h"

#include <fmt/ostream.h>

#include "drivers/v4l2/capture_format.h"
#include "drivers/v4l2/device_lookup.h"

namespace waymark {
namespace {

void print_block(std::ostream& out, std::size_t number, const VideoDevice& device,
                 const std::string& identity, VideoNode& node) {
  fmt::print(out, "# {}\n# offers {}\n", name_of(device), offered_formats(node));
  if (identity.empty()) {
    fmt::print(out, "# can't be told from another camera: plug it in elsewhere\n\n");
    return;
  }
  const auto formats = understood_formats(node);
  fmt::print(out, "[[camera]]\nname = \"cam{}\"\ndriver = \"v4l2\"\ndevice = \"{}\"\n", number,
             identity);
  if (!formats.empty()) fmt::print(out, "format = \"{}\"\n", formats.front().pixels->name);
  fmt::print(out, "# fps = 30, exposure_us = 2000, gain = …: see /etc/locd/locd.toml\n\n");
}

}  // namespace

Status list_cameras(VideoSystem& system, std::ostream& out) {
  const auto devices = find_cameras(system);
  std::size_t number = 0;
  for (const VideoDevice& device : devices) {
    const auto node = system.open(device.node);
    if (!node) {
      fmt::print(out, "# {}: {}\n\n", name_of(device), node.error().message);
      continue;
    }
    print_block(out, number++, device, identity_among(device, devices), **node);
  }
  if (!devices.empty()) return {};
  return fail(ErrorKind::unavailable, "no camera is plugged in, as far as V4L2 knows");
}

}  // namespace waymark
