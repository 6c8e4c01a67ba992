#include "mapbuilder/evaluate/ground_truth.h"

#include <algorithm>
#include <initializer_list>

#include "core/base/is_there.h"
#include "core/geometry/tum.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

Expected<std::map<MarkerId, Rigid3>> read_markers(const fs::path& path,
                                                  std::optional<Family> only_family) {
  const auto lines = read_tum(path);
  if (!lines) return tl::make_unexpected(lines.error());
  std::map<MarkerId, Rigid3> markers;
  for (const TumPose& line : *lines) {
    const auto id = parse_marker_id(line.key, only_family);
    if (!id) return fail(ErrorKind::bad_data, "{}: {}", path.string(), id.error().message);
    if (!markers.emplace(*id, line.pose).second) {
      return fail(ErrorKind::bad_data, "{}: marker {} stands there twice", path.string(), line.key);
    }
  }
  return markers;
}

std::optional<fs::path> first_there(const fs::path& folder,
                                    std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (is_there(folder / name)) return folder / name;
  }
  return std::nullopt;
}

}  // namespace

Expected<std::vector<StampedPose>> read_stamped_poses(const fs::path& path) {
  const auto lines = read_tum(path);
  if (!lines) return tl::make_unexpected(lines.error());
  std::vector<StampedPose> poses;
  for (const TumPose& line : *lines) {
    const auto stamp = parse_stamp_s(line.key);
    if (!stamp) return fail(ErrorKind::bad_data, "{}: {}", path.string(), stamp.error().message);
    poses.push_back({*stamp, line.pose});
  }
  std::sort(poses.begin(), poses.end(),
            [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
  const auto twice = std::adjacent_find(
      poses.begin(), poses.end(),
      [](const StampedPose& a, const StampedPose& b) { return a.stamp == b.stamp; });
  if (twice != poses.end()) {
    return fail(ErrorKind::bad_data, "{}: two poses at {} s", path.string(),
                format_stamp_s(twice->stamp));
  }
  return poses;
}

Expected<GroundTruth> read_ground_truth(const fs::path& folder, std::optional<Family> only_family) {
  GroundTruth truth;
  if (const auto path = first_there(folder, {"markers.tum", "marker_gt.txt"})) {
    auto markers = read_markers(*path, only_family);
    if (!markers) return tl::make_unexpected(markers.error());
    truth.world_from_marker = *std::move(markers);
  }
  if (const auto path = first_there(folder, {"rig.tum", "cam_gt.txt"})) {
    auto rig = read_stamped_poses(*path);
    if (!rig) return tl::make_unexpected(rig.error());
    truth.world_from_rig = *std::move(rig);
  }
  if (!truth.world_from_marker && !truth.world_from_rig) {
    return fail(ErrorKind::no_input,
                "{}: no ground truth: neither markers.tum nor rig.tum is there; name a capture's "
                "folder groundtruth",
                folder.string());
  }
  return truth;
}

}  // namespace waymark
