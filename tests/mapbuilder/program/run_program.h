#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/synthetic_room.h"
#include "tests/support/temporary_folder.h"

namespace waymark::test {

/// How a run of mapbuilder ended.
struct ProgramRun {
  int exit_code = -1;  ///< −1: ended by a signal
  std::string out;
  std::string err;
};

/// Runs mapbuilder with `arguments`. No file it writes may exceed `max_file_bytes` (0: no limit),
/// as on a disk that is full.
[[nodiscard]] ProgramRun run_mapbuilder(const std::vector<std::string>& arguments,
                                        std::size_t max_file_bytes = 0);

/// Number of lines on stderr that say why a run failed: "mapbuilder: …" or "error [cause] …".
[[nodiscard]] int error_lines(const ProgramRun& run);

/// Writes a room as a capture folder with detections.csv (rig.yaml, markers.toml beside it).
void write_capture(const SyntheticRoom& room, const std::filesystem::path& folder);

}  // namespace waymark::test
