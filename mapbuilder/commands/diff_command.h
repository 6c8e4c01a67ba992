#pragma once

#include <filesystem>
#include <ostream>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder diff OLD.map NEW.map [--json]`
struct DiffOptions {
  std::filesystem::path old_map;
  std::filesystem::path new_map;
  bool json = false;
};

/// Says on `out` what differs between two maps of one building, and what a vehicle will notice.
/// Errors: those of read_map_file; bad_data where the two can't be compared (difference_of).
[[nodiscard]] Status run_diff(const DiffOptions& options, std::ostream& out);

}  // namespace waymark
