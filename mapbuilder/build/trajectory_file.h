#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/growth/localized_frame_set.h"

namespace waymark {

/// Writes sub-map `submap`'s trajectory as TUM, world_from_rig by rising stamp: to the named file
/// for the first sub-map, to `stem.1.tum`… for the others; of mono frames one file per camera,
/// `stem.camN.tum`, world_from_cam. Every capture has files of its own, for stamps of two may
/// overlap: the first that was given those above, the second `stem.capture1.tum`,
/// `stem.capture1.1.tum`…, and so on; one without a pose an empty one. Errors of
/// write_file_atomically.
[[nodiscard]] Status write_trajectory(const std::filesystem::path& path, std::size_t submap,
                                      const Observations& observations,
                                      const std::vector<LocalizedFrameSet>& trajectory);

}  // namespace waymark
