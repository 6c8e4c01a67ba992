// Captures from devices by locd's own driver and nothing else, each device in a thread: how many
// frames come, how many are missing, what the images are. Exit code 1 when a frame is damaged, or
// of numbered ones missing.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <thread>
#include <vector>

#include "core/capture/image_file.h"
#include "drivers/monotonic_clock.h"
#include "drivers/v4l2/device_lookup.h"
#include "drivers/v4l2/v4l2_source.h"

namespace {

using namespace waymark;

struct Options {
  std::vector<std::string> devices;
  int width_px = 0;
  int height_px = 0;
  std::string format;
  std::uint64_t frames = 1;
  bool numbered = false;
  std::string save;
};

struct Result {
  std::uint64_t frames = 0;
  std::uint64_t missing = 0;
  std::uint64_t lost = 0;  ///< by the driver's count
  std::vector<double> gaps_ms;
  std::string failure;

  [[nodiscard]] double median_gap_ms() const {
    if (gaps_ms.empty()) return 0;
    std::vector<double> sorted = gaps_ms;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
  }
};

/// The number that feed wrote into a frame.
std::uint64_t number_of(const GrayView& image) {
  std::uint64_t number = 0;
  std::memcpy(&number, image.data, sizeof number);
  return number;
}

void capture(FrameSource& source, const Options& options, Result& result) {
  if (const Status started = source.start(); !started) {
    result.failure = started.error().message;
    return;
  }
  std::uint64_t expected = 0;
  Stamp last{0};
  std::uint64_t lost_before = 0;
  // What v4l2loopback gives first is of before the stream, and its count began anew with it.
  bool passed_over = !options.numbered;
  while (result.frames < options.frames) {
    auto frame = source.next(monotonic_now() + std::chrono::seconds(60));
    if (!frame || !*frame) {
      result.failure = frame ? "no frame for 60 s" : frame.error().message;
      break;
    }
    if (!passed_over) {
      passed_over = true;
      continue;
    }
    const Stamp arrival = (*frame)->info().arrival;
    if (result.frames == 0) {
      lost_before = source.lost();
    } else {
      result.gaps_ms.push_back(std::chrono::duration<double, std::milli>(arrival - last).count());
    }
    if (options.numbered) {
      const std::uint64_t number = number_of((*frame)->image());
      if (result.frames > 0) result.missing += number - expected;
      expected = number + 1;
    }
    last = arrival;
    ++result.frames;
    if (result.frames == options.frames && !options.save.empty()) {
      const auto saved = write_gray_image(options.save, (*frame)->image());
      if (!saved) result.failure = saved.error().message;
    }
  }
  result.lost = source.lost() - lost_before;
  source.close();
}

Expected<std::vector<std::unique_ptr<FrameSource>>> sources_of(const Options& options) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  const auto system = kernel_video_system();
  for (const std::string& device : options.devices) {
    auto identity = parse_device_identity(device);
    if (!identity) return tl::make_unexpected(identity.error());
    CameraOptions camera;
    camera.name = device;
    camera.device = std::move(*identity);
    camera.request.width_px = options.width_px;
    camera.request.height_px = options.height_px;
    if (!options.format.empty()) camera.request.pixels = find_pixel_format(options.format);
    sources.push_back(v4l2_source(system, camera));
  }
  return sources;
}

int run(const Options& options) {
  auto sources = sources_of(options);
  if (!sources) {
    fmt::print(stderr, "{}\n", sources.error().message);
    return sources.error().exit_code();
  }
  std::vector<Result> results(sources->size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < sources->size(); ++i) {
    threads.emplace_back(capture, std::ref(*(*sources)[i]), std::cref(options),
                         std::ref(results[i]));
  }
  for (std::thread& thread : threads) thread.join();
  bool well = true;
  for (std::size_t i = 0; i < sources->size(); ++i) {
    const FrameSource& source = *(*sources)[i];
    const Result& r = results[i];
    fmt::print("{}: {} frames, {:.1f} ms apart, {} missing, {} damaged, {} lost{}{}\n",
               source.name(), r.frames, r.median_gap_ms(), r.missing, source.damaged(), r.lost,
               r.failure.empty() ? "" : "; ", r.failure);
    // A device that counts for itself may leave frames out when the machine stands still; feed does
    // not.
    const std::uint64_t gaps = options.numbered ? r.missing + r.lost : 0;
    well = well && r.failure.empty() && gaps + source.damaged() == 0;
  }
  return well ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Captures by locd's V4L2 driver alone"};
  app.add_option("devices", options.devices, "As [[camera]] device names them")->required();
  app.add_option("--width", options.width_px)->required();
  app.add_option("--height", options.height_px)->required();
  app.add_option("--format", options.format, "As [[camera]] format names it");
  app.add_option("--frames", options.frames, "Of each device");
  app.add_flag("--numbered", options.numbered,
               "Frames carry their number as feed writes it: none may be missing");
  app.add_option("--save", options.save, "The last frame, as PGM");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
