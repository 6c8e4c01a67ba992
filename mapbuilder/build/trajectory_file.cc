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
                        const ObservationTable& table,
                        const std::vector<LocalizedFrameSet>& trajectory) {
  std::vector<std::map<int, StampedPoses>> by_capture(table.capture_names.size());  // by camera
  for (const LocalizedFrameSet& localized : trajectory) {
    const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(localized.frame_set)];
    by_capture[static_cast<std::size_t>(set.capture)][set.camera].emplace_back(
        set.stamp, localized.world_from_rig);
  }
  for (std::size_t c = 0; c < by_capture.size(); ++c) {
    const auto file = path_of_submap(path_of_capture(path, table.capture_places[c]), submap);
    if (by_capture[c].empty()) by_capture[c][-1];  // an empty trajectory is said by an empty file
    for (auto& [camera, poses] : by_capture[c]) {
      const auto own = camera >= 0 ? path_of_camera(file, fmt::format("cam{}", camera)) : file;
      if (auto written = write_poses(own, std::move(poses)); !written) return written;
    }
  }
  return {};
}

}  // namespace waymark
