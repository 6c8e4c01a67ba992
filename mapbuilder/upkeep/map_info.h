#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/map/marker_map.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/build/output_paths.h"
#include "mapbuilder/upkeep/marker_system.h"

namespace waymark {

/// MAP.info beside MAP: how the markers of a map depend on each other, for `update` at the desk;
/// nothing that a vehicle needs. A system per sub-map at the places of its markers; an empty one
/// where nothing is known. Little-endian:
///
///     8 bytes   "WAYINFO\n"
///     8 bytes   XXH3-64 over what follows
///     16 bytes  content hash of its map
///     uint32    sub-maps; then for each: uint32 markers (0: nothing known), uint32 blocks, then
///               per block uint32 row, uint32 column (by marker, row ≥ column; by rising row, then
///               column), 36 doubles
///
/// Writes atomically. Errors of write_file_atomically.
[[nodiscard]] Status write_map_info(const std::filesystem::path& map_path, const MarkerMap& map,
                                    const std::vector<MarkerSystem>& systems);

/// That of a build's map; none where survey or refinement tie the markers by what is not among
/// them.
[[nodiscard]] Status write_info_of_build(const std::filesystem::path& map_path,
                                         const Observations& observations,
                                         const BuildResult& result, const BuildOptions& options);

/// nullopt where there is none, or it belongs to another map (one that stood there before). Else a
/// system per sub-map, without markers where nothing is known. bad_data for a damaged one, or
/// whose blocks are parts of no information matrix.
[[nodiscard]] Expected<std::optional<std::vector<MarkerSystem>>> read_map_info(
    const std::filesystem::path& map_path, const MarkerMap& map);

}  // namespace waymark
