#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/import/bag_reader.h"

namespace waymark {

/// The files of a recording of ROS 2, in their order: of a folder those that its metadata.yaml
/// names, wherever it says that they lie, in the folder itself; a file is its own recording.
/// Errors: no_input, permission; bad_data for a folder without metadata.yaml, and one that names no
/// files.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> files_of_recording(
    const std::filesystem::path& recording);

/// Opens one of them, whichever storage it is of; messages that are packed with zstd one by one are
/// unpacked. Errors: those of open_mcap and open_sqlite_bag; bad_data for a recording of ROS 1 or
/// one that is packed as a whole, with how to convert it, and for any other file; unavailable where
/// this mapbuilder was built without what reads them.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_recorded(const std::filesystem::path& file,
                                                                 WantsTopic wants);

}  // namespace waymark
