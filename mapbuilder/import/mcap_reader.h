#pragma once

#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "mapbuilder/import/bag_reader.h"

namespace waymark {

/// Opens an MCAP file (https://mcap.dev/spec), which is read from front to end, record by record:
/// no index is needed. Chunks without compression, with lz4 or zstd are unpacked as they are read;
/// their checksums are held against what comes. Errors: those of InputFile::open; bad_data for
/// another version of the format.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_mcap(const std::filesystem::path& path,
                                                             WantsTopic wants);

}  // namespace waymark
