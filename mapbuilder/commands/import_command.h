#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/import/described_capture.h"

namespace waymark {

/// `mapbuilder import FILE -o MAP`, and of what others record `mapbuilder import BAG|MCAP|LCMLOG
/// -o CAPTURE [--rig RIG] [--markers MARKERS] [--camera TOPIC]... [--every N] [--channel NAME]`
struct ImportOptions {
  /// A map's JSON as export writes it or measured by hand, rosbag2's folder or file, an MCAP file,
  /// or lcm-logger's log of locd's detections.
  std::filesystem::path input;
  std::filesystem::path output;
  CaptureDescription description;    ///< of recordings
  std::vector<std::string> cameras;  ///< of recordings of ROS 2: topics, cam0's first
  std::optional<int> every;          ///< likewise; default 1
  std::string channel;               ///< of logs of LCM
};

/// Turns a map's JSON form into a map file and names its content on `out`, or what others recorded
/// into a capture folder, with what it still lacks on `notes`. Errors: usage when the map would
/// replace the JSON, and for options that the input has nothing to do with; those of
/// parse_map_json, read_file and write_map_file; those of import_bag and import_lcm_log;
/// unavailable for recordings of ROS 2 where this mapbuilder was built without them.
[[nodiscard]] Status run_import(const ImportOptions& options, Progress& progress, std::ostream& out,
                                std::ostream& notes);

}  // namespace waymark
