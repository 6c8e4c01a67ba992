#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/camera/rig.h"
#include "core/capture/capture_folder.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/observations/detect_capture.h"
#include "mapbuilder/observations/detect_videos.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

/// What the command line names as input: captures, or, with --rig and --markers, the videos of one
/// or logs of locd's detections, each a capture.
struct CaptureInput {
  std::vector<std::filesystem::path> paths;
  std::optional<std::filesystem::path> rig_yaml;      ///< with it the paths are videos or logs
  std::optional<std::filesystem::path> markers_toml;  ///< likewise
  VideoOptions video;
  DetectCaptureOptions detect;
  /// The command could use a survey and was given none: a capture's own is said not to be used.
  bool survey_not_asked = false;
  /// Whether captures must have a rig file; videos must.
  RigFile rig_file = RigFile::required;
  /// Numbers in place of those that captures have, of the same cameras, the first of them alike.
  std::optional<Rig> known_rig;
};

/// Captures with what was found wrong with them.
struct TakenCaptures {
  std::vector<DetectedCapture> captures;
  std::vector<Finding> findings;
};

/// Fails (usage) when `output` would take the place of what the captures or videos are read from,
/// or of one of the `others`; `remedy` ends the line.
[[nodiscard]] Status check_spares_input(
    const std::filesystem::path& output, const CaptureInput& input,
    const std::vector<std::optional<std::filesystem::path>>& others,
    const char* remedy = "name another file");

/// Opens captures, videos or logs and makes or reads their detections; what the user should know
/// goes to `notes`, a line each, at most 20 of a kind. Errors of open_capture, detect_capture,
/// detect_videos and take_logged_capture; usage for a video or log without --rig and --markers,
/// and for logs among others.
[[nodiscard]] Expected<TakenCaptures> take_captures_in(const CaptureInput& input,
                                                       Progress& progress, std::ostream& notes);

/// bad_data where nothing at all was seen of markers: no long work could make anything of it, and a
/// pose of each image would take a thousand bytes. `capture` begins the line.
[[nodiscard]] Status check_any_seen(const Observations& observations,
                                    const std::filesystem::path& capture);

}  // namespace waymark
