#include "mapbuilder/evaluate/trajectory.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "core/base/check.h"
#include "core/base/folder_walk.h"
#include "core/base/text_field.h"
#include "mapbuilder/build/output_paths.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// Stamps this close mean one exposure: a TUM file may have come through other tools' rounding.
constexpr Stamp kMatchTolerance = std::chrono::milliseconds(1);

/// N of a stem "….camN".
std::optional<std::size_t> camera_number_of(const fs::path& path) {
  const std::string suffix = path.stem().extension().string();
  if (!suffix.starts_with(".cam")) return std::nullopt;
  return parse_whole<std::size_t>(std::string_view(suffix).substr(4));
}

/// Files `out.camN.tum` beside `path` = `out.tum`, by camera number.
std::map<std::size_t, fs::path> camera_files_beside(const fs::path& path) {
  std::map<std::size_t, fs::path> files;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  walk_folder<fs::directory_iterator>(folder, [&](const fs::directory_entry& entry) {
    const auto number = camera_number_of(entry.path());
    if (!number) return;
    const fs::path expected = path_of_camera(path, "cam" + std::to_string(*number));
    if (entry.path().filename() == expected.filename()) files.emplace(*number, expected);
  });
  return files;
}

Expected<Trajectory> read_one(const fs::path& path, std::optional<std::size_t> camera) {
  auto poses = read_stamped_poses(path);
  if (!poses) return tl::make_unexpected(poses.error());
  Trajectory trajectory;
  if (camera) trajectory.camera = "cam" + std::to_string(*camera);
  trajectory.poses = *std::move(poses);
  return trajectory;
}

/// The named file's place for a sub-map: of `out.cam0.tum` it is `out.1.cam0.tum`.
fs::path of_submap(const fs::path& path, std::size_t submap) {
  const auto camera = camera_number_of(path);
  if (!camera) return path_of_submap(path, submap);
  fs::path whole = path.parent_path() / path.stem().stem();
  whole += path.extension();
  return path_of_camera(path_of_submap(whole, submap), "cam" + std::to_string(*camera));
}

Stamp apart(Stamp a, Stamp b) { return time_between(std::min(a, b), std::max(a, b)); }

/// The true pose nearest in time, nullptr when none is near enough.
const StampedPose* at_stamp(const std::vector<StampedPose>& truth, Stamp stamp) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), stamp,
                       [](const StampedPose& pose, Stamp wanted) { return pose.stamp < wanted; });
  const StampedPose* best = after == truth.end() ? nullptr : &*after;
  if (after != truth.begin()) {
    const StampedPose& before = *std::prev(after);
    if (best == nullptr || apart(before.stamp, stamp) < apart(stamp, best->stamp)) best = &before;
  }
  if (best == nullptr || apart(best->stamp, stamp) > kMatchTolerance) return nullptr;
  return best;
}

/// Where the trajectory's frame lies on the rig.
Expected<Rigid3> rig_from_frame(const Trajectory& trajectory, const Rig* rig) {
  if (!trajectory.camera) return Rigid3{};
  WAYMARK_CHECK(rig != nullptr);
  const auto found = std::find_if(rig->cameras.begin(), rig->cameras.end(),
                                  [&](const RigCamera& c) { return c.name == *trajectory.camera; });
  if (found == rig->cameras.end()) {
    return fail(ErrorKind::bad_data,
                "trajectory of {}: the true capture's rig.yaml has no such camera",
                *trajectory.camera);
  }
  return found->rig_from_cam;
}

}  // namespace

Expected<std::vector<Trajectory>> read_trajectories(const fs::path& path, std::size_t submap) {
  const fs::path named = of_submap(path, submap);
  std::vector<Trajectory> trajectories;
  std::error_code why;
  // What can't be looked at is for the reader to say.
  if (fs::status(named, why).type() != fs::file_type::not_found) {
    auto trajectory = read_one(named, camera_number_of(named));
    if (!trajectory) return tl::make_unexpected(trajectory.error());
    trajectories.push_back(*std::move(trajectory));
    return trajectories;
  }
  for (const auto& [camera, file] : camera_files_beside(named)) {
    auto trajectory = read_one(file, camera);
    if (!trajectory) return tl::make_unexpected(trajectory.error());
    trajectories.push_back(*std::move(trajectory));
  }
  return trajectories;
}

Expected<MatchedPoses> match_with_truth(const std::vector<Trajectory>& trajectories,
                                        const std::vector<StampedPose>& world_from_rig,
                                        const Rig* rig) {
  MatchedPoses matched;
  for (const Trajectory& trajectory : trajectories) {
    const auto frame = rig_from_frame(trajectory, rig);
    if (!frame) return tl::make_unexpected(frame.error());
    matched.truth += world_from_rig.size();
    for (const StampedPose& pose : trajectory.poses) {
      const StampedPose* const truth = at_stamp(world_from_rig, pose.stamp);
      if (truth != nullptr) matched.pairs.push_back({pose.pose, truth->pose * *frame});
    }
  }
  return matched;
}

}  // namespace waymark
