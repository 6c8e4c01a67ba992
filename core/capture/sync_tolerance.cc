#include "core/capture/sync_tolerance.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/median.h"

namespace waymark {

std::vector<Stamp> spacings_of(std::span<const StampedImage> images) {
  std::map<int, std::vector<Stamp>> by_camera;
  for (const StampedImage& image : images) by_camera[image.camera].push_back(image.stamp);
  std::vector<Stamp> spacings;
  for (auto& [camera, stamps] : by_camera) {
    std::sort(stamps.begin(), stamps.end());
    stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
    for (std::size_t i = 1; i < stamps.size(); ++i) {
      spacings.push_back(time_between(stamps[i - 1], stamps[i]));
    }
  }
  return spacings;
}

UsableTolerance usable_tolerance(Stamp stated, Stamp period, std::size_t cameras) {
  if (cameras < 2) return {stated, std::nullopt};
  const Stamp most = period - period / static_cast<Stamp::rep>(cameras);
  if (stated <= most) return {stated, std::nullopt};
  return {most,
          fmt::format("a camera's frames come every {:.3f} ms: those of one instant are looked for "
                      "within {:.3f} ms, not within the sync tolerance of {:.3f} ms, which would "
                      "take the next ones",
                      1e3 * in_s(period), 1e3 * in_s(most), 1e3 * in_s(stated))};
}

UsableTolerance usable_tolerance(Stamp stated, std::span<const StampedImage> images,
                                 std::size_t cameras) {
  std::vector<Stamp> spacings = spacings_of(images);
  if (spacings.empty()) return {stated, std::nullopt};
  return usable_tolerance(stated, upper_median(spacings), cameras);
}

}  // namespace waymark
