#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "mapbuilder/evaluate/ground_truth.h"
#include "mapbuilder/evaluate/pose_accuracy.h"

namespace waymark {

/// Estimated poses of a rig, or of one of its cameras.
struct Trajectory {
  std::optional<std::string> camera;  ///< poses are world_from_cam of this one, else world_from_rig
  std::vector<StampedPose> poses;     ///< by rising stamp
};

/// The trajectories of sub-map `submap` as build and localize write them for `--trajectory path`:
/// the rig's (`out.tum`) or, of a mono build, one per camera (`out.cam0.tum`, …); a camera's file
/// may also be named itself. Empty when there is none.
[[nodiscard]] Expected<std::vector<Trajectory>> read_trajectories(const std::filesystem::path& path,
                                                                  std::size_t submap);

/// Estimated poses and the true ones at their stamps.
struct MatchedPoses {
  std::size_t truth = 0;  ///< true poses there are: of the rig, or of each camera with a trajectory
  std::vector<PosePair> pairs;  ///< those with a true pose within 1 ms
};

/// Pairs trajectories with the truth; cameras' true poses are world_from_rig ∘ rig_from_cam.
/// bad_data for a camera that `rig` lacks; `rig` may be nullptr when no trajectory is a camera's.
[[nodiscard]] Expected<MatchedPoses> match_with_truth(
    const std::vector<Trajectory>& trajectories, const std::vector<StampedPose>& world_from_rig,
    const Rig* rig);

}  // namespace waymark
