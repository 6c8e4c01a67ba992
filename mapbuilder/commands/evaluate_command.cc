#include "mapbuilder/commands/evaluate_command.h"

#include <algorithm>

#include "core/camera/kalibr.h"
#include "core/map/map_file.h"
#include "mapbuilder/evaluate/evaluation.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// The rig of the capture that the truth belongs to, where a trajectory is a camera's.
Expected<std::optional<Rig>> rig_for(const std::vector<Trajectory>& trajectories,
                                     const fs::path& truth) {
  const bool needed = std::any_of(trajectories.begin(), trajectories.end(),
                                  [](const Trajectory& t) { return t.camera.has_value(); });
  if (!needed) return std::nullopt;
  auto loaded = read_camchain(truth / ".." / "rig.yaml");
  if (!loaded) {
    return fail(loaded.error().kind,
                "{}; it is needed because a mono trajectory holds poses of cameras",
                loaded.error().message);
  }
  return std::move(loaded->rig);
}

/// A sub-map's trajectory against the truth; nullopt when the sub-map has none.
Expected<std::optional<CameraEvaluation>> evaluate_trajectory(const EvaluateOptions& options,
                                                              std::size_t submap,
                                                              const GroundTruth& truth,
                                                              const MarkerEvaluation* markers) {
  const auto trajectories = read_trajectories(*options.trajectory, submap);
  if (!trajectories) return tl::make_unexpected(trajectories.error());
  if (trajectories->empty()) return std::nullopt;
  const auto rig = rig_for(*trajectories, options.truth);
  if (!rig) return tl::make_unexpected(rig.error());
  const auto poses =
      match_with_truth(*trajectories, *truth.world_from_rig, *rig ? &**rig : nullptr);
  if (!poses) return tl::make_unexpected(poses.error());
  return evaluate_cameras(*poses, markers);
}

/// Nothing in common means that truth and estimate are of different captures.
Status check_overlap(const EvaluateOptions& options, const std::vector<SubMapEvaluation>& submaps) {
  const auto found_markers = [](const SubMapEvaluation& s) {
    return !s.markers || !s.markers->found.empty();
  };
  if (std::none_of(submaps.begin(), submaps.end(), found_markers)) {
    return fail(ErrorKind::bad_data,
                "{}: no marker of the map {} is in the truth; they are of different places",
                (options.truth / "markers.tum").string(), options.map.string());
  }
  if (!options.trajectory) return {};
  if (!submaps.front().cameras) {
    return fail(ErrorKind::no_input, "{}: can't open: no such trajectory, nor one per camera",
                options.trajectory->string());
  }
  const auto found_poses = [](const SubMapEvaluation& s) {
    return s.cameras && s.cameras->found > 0;
  };
  if (std::none_of(submaps.begin(), submaps.end(), found_poses)) {
    return fail(ErrorKind::bad_data,
                "{}: no pose lies within 1 ms of one in {}; the stamps are of different captures",
                options.trajectory->string(), (options.truth / "rig.tum").string());
  }
  return {};
}

}  // namespace

Status run_evaluate(const EvaluateOptions& options, std::ostream& out) {
  const auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  const auto truth = read_ground_truth(options.truth, map->families().only());
  if (!truth) return tl::make_unexpected(truth.error());
  if (options.trajectory && !truth->world_from_rig) {
    return fail(ErrorKind::no_input, "{}: absent; without it a trajectory can't be evaluated",
                (options.truth / "rig.tum").string());
  }
  std::vector<SubMapEvaluation> submaps;
  for (std::size_t i = 0; i < map->submaps.size(); ++i) {
    SubMapEvaluation& submap = submaps.emplace_back();
    if (truth->world_from_marker) {
      submap.markers = evaluate_markers(map->submaps[i], *truth->world_from_marker);
    }
    if (!options.trajectory) continue;
    auto cameras =
        evaluate_trajectory(options, i, *truth, submap.markers ? &*submap.markers : nullptr);
    if (!cameras) return tl::make_unexpected(cameras.error());
    submap.cameras = *std::move(cameras);
  }
  if (auto status = check_overlap(options, submaps); !status) return status;
  out << (options.json ? format_evaluation_json(submaps, map->several_families())
                       : format_evaluation_text(submaps, map->several_families()));
  return {};
}

}  // namespace waymark
