#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/mapping/map_builder.h"

namespace waymark {

/// Writes sub-map `submap`'s trajectory as TUM, world_from_rig by rising stamp: to the named file
/// for the first sub-map, to `stem.1.tum`… for the others; of mono frames one file per camera,
/// `stem.camN.tum`, world_from_cam. Errors of write_file_atomically.
[[nodiscard]] Status write_trajectory(const std::filesystem::path& path, std::size_t submap,
                                      const ObservationTable& table,
                                      const std::vector<LocalizedFrameSet>& trajectory);

}  // namespace waymark
