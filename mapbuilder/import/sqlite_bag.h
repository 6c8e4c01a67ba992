#pragma once

#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "mapbuilder/import/bag_reader.h"

namespace waymark {

/// Opens a file of rosbag2's sqlite3 storage (tables topics and messages) by libsqlite3, read only
/// and as if nobody wrote to it. The database's own schema is not trusted: what is no plain table
/// is not read, and what a query may do is bounded by the file's size. Errors: those of
/// InputFile::open; bad_data for a database that is no recording, is damaged, or has a journal
/// beside it that was never written back.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_sqlite_bag(
    const std::filesystem::path& path, WantsTopic wants);

}  // namespace waymark
