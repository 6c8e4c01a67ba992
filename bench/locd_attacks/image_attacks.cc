#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "bench/locd_attacks/attack.h"
#include "core/base/check.h"

namespace waymark::bench {
namespace {

Attack clean() {
  return {"clean", [](World&) {}, {}, {}, 0, {}, {}, false};
}

Attack noise(double factor, int begins, std::optional<int> ends, std::string name) {
  return {std::move(name),
          [](World&) {},
          [=](World& w, SimulatedDrive& drive, int set) {
            if (set == begins) drive.set_noise(factor * w.drive.noise_px);
            if (ends && set == *ends) drive.set_noise(w.drive.noise_px);
          },
          {},
          begins,
          ends,
          {},
          false};
}

/// From set 300 on, cameras give two detections of sets 298 and 299 in turn, with new stamps.
Attack stale() {
  auto kept = std::make_shared<std::array<std::vector<ImageDetections>, 2>>();
  auto given = std::make_shared<std::vector<ImageDetections>>();
  return {"two stale buffers in turn",
          [=](World& w) {
            for (std::size_t c = 0; c < w.rig.cameras.size(); ++c) {
              w.guilty_cameras.insert(static_cast<int>(c));
            }
          },
          {},
          [=](FrameSetLease& set, int number) {
            constexpr int kBegins = 300;
            if (number == kBegins - 2 || number == kBegins - 1) {
              auto& to = (*kept)[static_cast<std::size_t>(number % 2)];
              to.clear();
              for (std::size_t c = 0; c < kMaxCameras; ++c) {
                if (set.has(c)) to.push_back(*set.frames[c].detections());
              }
            }
            if (number < kBegins) return;
            *given = (*kept)[static_cast<std::size_t>(number % 2)];
            for (ImageDetections& image : *given) {
              const auto c = static_cast<std::size_t>(image.camera);
              const FrameInfo info = set.frames[c].info();
              image.stamp = info.stamp;
              set.frames[c] = Frame(info, {}, &image, nullptr, 0);
            }
          },
          300,
          {},
          {AlertKind::image_stale},
          false};
}

}  // namespace

std::vector<Attack> image_attacks() {
  return {
      clean(),
      noise(10, 0, {}, "noise x 10 from the start"),
      noise(10, 600, {}, "noise x 10 from set 600"),
      noise(10, 600, 900, "noise x 10, sets 600-900"),
      noise(3, 600, 900, "noise x 3, sets 600-900"),
      stale(),
  };
}

}  // namespace waymark::bench
