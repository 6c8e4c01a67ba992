#include "mapbuilder/mapping/trajectory_file.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/geometry/tum.h"
#include "mapbuilder/output/output_paths.h"

namespace waymark {

Status write_trajectory(const std::filesystem::path& path, std::size_t submap,
                        const ObservationTable& table,
                        const std::vector<LocalizedFrameSet>& trajectory) {
  std::map<int, std::vector<std::pair<Stamp, Rigid3>>> by_camera;
  for (const LocalizedFrameSet& localized : trajectory) {
    const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(localized.frame_set)];
    by_camera[set.camera].emplace_back(set.stamp, localized.world_from_rig);
  }
  if (by_camera.empty()) by_camera[-1];  // an empty trajectory is said by an empty file
  for (auto& [camera, poses] : by_camera) {
    std::stable_sort(poses.begin(), poses.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<TumPose> lines;
    lines.reserve(poses.size());
    for (const auto& [stamp, pose] : poses) lines.push_back({format_stamp_s(stamp), pose});
    auto file = path_of_submap(path, submap);
    if (camera >= 0) file = path_of_camera(file, fmt::format("cam{}", camera));
    if (auto written = write_file_atomically(file, format_tum(lines)); !written) return written;
  }
  return {};
}

}  // namespace waymark
