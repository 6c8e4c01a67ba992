#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder info MAP [--json] [--distance ID ID]`
struct InfoOptions {
  std::filesystem::path map;
  bool json = false;
  /// Two ids, "12" or "tag36h11:12": how far these markers are apart is said in place of the rest.
  std::optional<std::pair<std::string, std::string>> distance;
};

/// Says what a map file holds, or how far two of its markers are apart, on `out`. Errors of
/// read_map_file; of a distance: usage (one marker named twice), bad_data (no such id, no such
/// marker, two that stand in different sub-maps).
[[nodiscard]] Status run_info(const InfoOptions& options, std::ostream& out);

}  // namespace waymark
