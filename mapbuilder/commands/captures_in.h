#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/observations/detect_capture.h"
#include "mapbuilder/observations/detect_videos.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

/// What the command line names as input: captures, or, with --rig and --markers, the videos of one.
struct CaptureInput {
  std::vector<std::filesystem::path> paths;
  std::optional<std::filesystem::path> rig_yaml;      ///< with it the paths are videos
  std::optional<std::filesystem::path> markers_toml;  ///< likewise
  VideoOptions video;
  DetectCaptureOptions detect;
  bool survey_given = false;  ///< else a capture's own survey is said not to be used
};

/// Opens captures or videos and makes or reads their detections; what the user should know goes to
/// `notes`, a line each, at most 20 of a kind. Errors of open_capture, detect_capture and
/// detect_videos; usage for a video without --rig and --markers.
[[nodiscard]] Expected<std::vector<DetectedCapture>> take_captures_in(const CaptureInput& input,
                                                                      Progress& progress,
                                                                      std::ostream& notes);

/// Fails early, before long work, when `path` can't be written: its folder is absent or not
/// writable, or it is a folder.
[[nodiscard]] Status check_writable(const std::filesystem::path& path);

/// What the user should know of observations that could not be used.
void print_observation_notes(const Observations& observations, std::ostream& notes);

}  // namespace waymark
