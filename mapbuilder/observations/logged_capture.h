#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/observations/detect_capture.h"

namespace waymark {

/// A log of locd's detections that takes a capture folder's place.
struct LoggedCapture {
  std::filesystem::path log;
  std::filesystem::path rig_yaml;
  std::filesystem::path markers_toml;
};

/// The capture that a log tells, corners as locd saw them. Markers that markers.toml ignores or
/// lacks are left out and counted, as in detections.csv. Errors: those of read_lcm_detections, of
/// the rig and of the catalog; bad_data when locd had another rig file.
[[nodiscard]] Expected<DetectedCapture> take_logged_capture(const LoggedCapture& logged,
                                                            Progress& progress,
                                                            DetectionReport& report);

}  // namespace waymark
