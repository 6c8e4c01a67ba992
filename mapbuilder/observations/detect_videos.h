#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/import/video_source.h"
#include "mapbuilder/observations/detect_capture.h"

namespace waymark {

/// Videos that take a capture folder's place, one per camera of the rig.
struct VideoCapture {
  std::vector<std::filesystem::path> videos;  ///< in the order of the rig's cameras
  std::filesystem::path rig_yaml;
  std::filesystem::path markers_toml;
  VideoOptions options;
};

/// Detects the markers in videos, frame by frame, several at a time; no frame is kept, and edges
/// are not corrected. Errors: those of open_videos, of the rig and of the catalog; bad_data for a
/// video whose stamps don't rise.
[[nodiscard]] Expected<DetectedCapture> detect_videos(const VideoCapture& capture,
                                                      const DetectCaptureOptions& options,
                                                      Progress& progress, DetectionReport& report);

}  // namespace waymark
