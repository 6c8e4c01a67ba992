#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/stamp.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// A pose at a time.
struct StampedPose {
  Stamp stamp{0};
  Rigid3 pose;
};

/// What is known to be true of a capture (its folder groundtruth/).
struct GroundTruth {
  std::optional<std::map<MarkerId, Rigid3>> world_from_marker;  ///< markers.tum, where it is there
  std::optional<std::vector<StampedPose>> world_from_rig;       ///< rig.tum, by rising stamp
};

/// Reads markers.tum and rig.tum of a folder groundtruth, or marker_gt.txt and cam_gt.txt of one of
/// the paper's data sets. Bare marker numbers mean `only_family`; where that is nullopt, several
/// families meet and ids must name theirs. no_input when neither file is there; bad_data with the
/// file for ids or stamps that are none or repeat.
[[nodiscard]] Expected<GroundTruth> read_ground_truth(const std::filesystem::path& folder,
                                                      std::optional<Family> only_family);

/// Reads a TUM file of stamped poses, by rising stamp. bad_data for stamps that are none or repeat.
[[nodiscard]] Expected<std::vector<StampedPose>> read_stamped_poses(
    const std::filesystem::path& path);

}  // namespace waymark
