// Writes grey frames to v4l2loopback devices at a steady rate until it is ended: frame k of each
// begins with k, eight bytes little-endian, the rest is a pattern. Usage: feed WIDTH HEIGHT FPS
// DEVICE...
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "core/base/descriptor.h"
#include "core/base/system_call.h"
#include "drivers/monotonic_clock.h"

namespace {

using namespace waymark;

Descriptor open_output(const char* path, std::uint32_t width, std::uint32_t height) {
  Descriptor device(::open(path, O_WRONLY | O_CLOEXEC));
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = width;
  format.fmt.pix.height = height;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  format.fmt.pix.bytesperline = width;
  format.fmt.pix.sizeimage = width * height;
  if (!device.valid() || ::ioctl(device.get(), VIDIOC_S_FMT, &format) != 0) {
    fmt::print(stderr, "feed: {}: {}\n", path, system_reason());
    return {};
  }
  return device;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) return 64;
  const auto width = static_cast<std::uint32_t>(std::atoi(argv[1]));
  const auto height = static_cast<std::uint32_t>(std::atoi(argv[2]));
  const Stamp period(static_cast<Stamp::rep>(1e9 / std::atof(argv[3])));
  // No camera sends its frames closer together than this.
  const Stamp least_gap = period / 2;
  std::vector<Descriptor> devices;
  for (int i = 4; i < argc; ++i) {
    devices.push_back(open_output(argv[i], width, height));
    if (!devices.back().valid()) return 69;
  }
  std::string image(static_cast<std::size_t>(width) * height, '\x40');
  Stamp due = monotonic_now();
  for (std::uint64_t k = 0;; ++k) {
    std::this_thread::sleep_until(as_time_point(due));
    std::memcpy(image.data(), &k, sizeof k);
    for (const Descriptor& device : devices) {
      if (!write_all(device.get(), image)) return 74;
    }
    due += period;
    // An emulated machine may stand still for a while. Its camera stood still with it: what it
    // missed it does not send in a burst.
    const Stamp earliest = monotonic_now() + least_gap;
    if (earliest > due + period) {
      fmt::print("stood still for {:.0f} ms after frame {}\n",
                 std::chrono::duration<double, std::milli>(earliest - due).count(), k);
      std::fflush(stdout);
    }
    due = std::max(due, earliest);
  }
}
