#include "mapbuilder/build/trajectory_file.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/geometry/tum.h"
#include "mapbuilder/build/output_paths.h"

namespace waymark {

namespace {

using StampedPoses = std::vector<std::pair<Stamp, Rigid3>>;

Status write_poses(const std::filesystem::path& path, StampedPoses poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<TumPose> lines;
  lines.reserve(poses.size());
  for (const auto& [stamp, pose] : poses) lines.push_back({format_stamp_s(stamp), pose});
  return write_file_atomically(path, format_tum(lines));
}

}  // namespace

Status write_trajectory(const std::filesystem::path& path, std::size_t submap,
                        const Observations& observations,
                        const std::vector<LocalizedFrameSet>& trajectory) {
  using ByCamera = std::map<std::optional<int>, StampedPoses>;
  IndexedVector<CaptureIndex, ByCamera> by_capture(observations.captures.size());
  for (const LocalizedFrameSet& localized : trajectory) {
    const ObservedFrameSet& set = observations.frame_sets[localized.frame_set];
    by_capture[set.capture][set.mono_camera].emplace_back(set.stamp, localized.world_from_rig);
  }
  for (const CaptureIndex c : by_capture.indices()) {
    const auto file = path_of_submap(path_of_capture(path, observations.captures[c].place), submap);
    // An empty trajectory is said by an empty file.
    if (by_capture[c].empty()) by_capture[c][std::nullopt];
    for (auto& [camera, poses] : by_capture[c]) {
      const auto own = camera ? path_of_camera(file, fmt::format("cam{}", *camera)) : file;
      if (auto written = write_poses(own, std::move(poses)); !written) return written;
    }
  }
  return {};
}

}  // namespace waymark
