// Writes grey frames to v4l2loopback devices at a steady rate: frame k of each begins with k, eight
// bytes little-endian, the rest is a pattern. Usage: feed WIDTH HEIGHT FPS SECONDS DEVICE...
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

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
  if (argc < 6) return 64;
  const auto width = static_cast<std::uint32_t>(std::atoi(argv[1]));
  const auto height = static_cast<std::uint32_t>(std::atoi(argv[2]));
  const Stamp period(static_cast<Stamp::rep>(1e9 / std::atof(argv[3])));
  const auto frames = static_cast<std::uint64_t>(std::atof(argv[3]) * std::atof(argv[4]));
  std::vector<Descriptor> devices;
  for (int i = 5; i < argc; ++i) {
    devices.push_back(open_output(argv[i], width, height));
    if (!devices.back().valid()) return 69;
  }
  std::string image(static_cast<std::size_t>(width) * height, '\x40');
  const Stamp begin = monotonic_now();
  std::uint64_t late = 0;
  for (std::uint64_t k = 0; k < frames; ++k) {
    const Stamp due = begin + static_cast<Stamp::rep>(k) * period;
    if (monotonic_now() > due + period) ++late;
    std::this_thread::sleep_until(as_time_point(due));
    std::memcpy(image.data(), &k, sizeof k);
    for (const Descriptor& device : devices) {
      if (!write_all(device.get(), image)) return 74;
    }
  }
  fmt::print("{} frames to each of {} devices, {} more than a period late\n", frames,
             devices.size(), late);
  return 0;
}
