#pragma once

#include <filesystem>
#include <ostream>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder info MAP [--json]`
struct InfoOptions {
  std::filesystem::path map;
  bool json = false;
};

/// Says what a map file holds, on `out`. Errors of read_map_file.
[[nodiscard]] Status run_info(const InfoOptions& options, std::ostream& out);

}  // namespace waymark
