#pragma once

#include <filesystem>
#include <ostream>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder import FILE -o MAP`
struct ImportOptions {
  std::filesystem::path json;  ///< as export writes it, or a map measured by hand
  std::filesystem::path output;
};

/// Turns a map's JSON form into a map file and names its content on `out`. Errors: usage when the
/// map would replace the JSON; those of
/// parse_map_json, read_file and write_map_file.
[[nodiscard]] Status run_import(const ImportOptions& options, std::ostream& out);

}  // namespace waymark
