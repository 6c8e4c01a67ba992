#pragma once

#include <filesystem>

#include "core/base/error.h"

namespace waymark {

/// What other programs record, told by the first bytes of a file.
enum class RecordedFile {
  other,     ///< none of these
  lcm_log,   ///< lcm-logger's
  mcap,      ///< MCAP, alone or as rosbag2's storage
  sqlite,    ///< a database: rosbag2's other storage
  ros1_bag,  ///< of the first ROS, which is not read
  zstd,      ///< packed as a whole, which is not read either
};

/// Errors: those of InputFile::open, but for its size.
[[nodiscard]] Expected<RecordedFile> kind_of_file(const std::filesystem::path& path);

}  // namespace waymark
