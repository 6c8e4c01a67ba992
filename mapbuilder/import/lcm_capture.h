#pragma once

#include <filesystem>
#include <ostream>
#include <string>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/camera/rig.h"
#include "mapbuilder/import/described_capture.h"
#include "mapbuilder/import/lcm_detections.h"

namespace waymark {

/// A log of locd's detections, and what becomes a capture with them.
struct LcmCaptureOptions {
  std::filesystem::path log;
  std::filesystem::path output;    ///< the capture folder
  CaptureDescription description;  ///< what goes beside
  std::string channel;             ///< which, where several hold detections; empty: the only one
};

/// bad_data where the log says that locd had another rig file than `rig`, whose name is `path`.
[[nodiscard]] Status check_rig_of_log(const LoggedDetections& logged, const Rig& rig,
                                      const std::filesystem::path& path);

/// Writes the log's detections as a capture folder: detections.csv with covariances, capture.toml,
/// and the files that were named. What is still missing goes to `notes`, a line each; what was
/// written to `out`. Errors: those of read_lcm_detections, of rig and catalog, check_rig_of_log and
/// GrowingFolder.
[[nodiscard]] Status import_lcm_log(const LcmCaptureOptions& options, Progress& progress,
                                    std::ostream& out, std::ostream& notes);

}  // namespace waymark
