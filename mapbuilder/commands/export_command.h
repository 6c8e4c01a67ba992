#pragma once

#include <filesystem>
#include <ostream>
#include <string>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder export MAP --format tum|json|csv|ply -o FILE`
struct ExportOptions {
  std::filesystem::path map;
  std::string format;  ///< tum, json, csv or ply
  std::filesystem::path output;
};

/// Writes a map in another form. JSON holds all sub-maps in one file; of the other forms the first
/// sub-map goes to the named file, the others to `stem.1.tum`…, which `notes` (stderr) says.
/// Errors: usage (an unknown format; an output that would replace the map), those of read_map_file
/// and write_file_atomically.
[[nodiscard]] Status run_export(const ExportOptions& options, std::ostream& notes);

}  // namespace waymark
