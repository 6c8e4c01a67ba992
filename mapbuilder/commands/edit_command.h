#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder edit MAP -o MAP [--remove IDS] [--rename ID=ID] [--accept IDS]`
struct EditOptions {
  std::filesystem::path map;
  std::filesystem::path output;     ///< may be the map itself
  std::vector<std::string> remove;  ///< each "100-199, 205" or "tag36h11:12"
  std::vector<std::string> rename;  ///< each "12=40"
  std::vector<std::string> accept;  ///< as remove; see MapEdit
};

/// Writes the map with what somebody knows about it changed by hand, and says on `out` what was
/// done; notes that nothing hangs on go to `notes`. The file is replaced whole or not at all.
/// Errors: usage when nothing is asked for; those of read_map_file, parse_marker_ids, edit_map and
/// write_map_file.
[[nodiscard]] Status run_edit(const EditOptions& options, std::ostream& out, std::ostream& notes);

}  // namespace waymark
