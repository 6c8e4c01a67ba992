#pragma once

#include <filesystem>
#include <ostream>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/mapping/detect_capture.h"

namespace waymark {

/// Opens captures and makes or reads their detections; what the user should know goes to `notes`, a
/// line each, at most 20 of a kind. Errors of open_capture and detect_capture.
[[nodiscard]] Expected<std::vector<DetectedCapture>> take_captures_in(
    const std::vector<std::filesystem::path>& paths, const DetectCaptureOptions& options,
    Progress& progress, std::ostream& notes);

/// Fails early, before long work, when `path` can't be written: its folder is absent or not
/// writable, or it is a folder.
[[nodiscard]] Status check_writable(const std::filesystem::path& path);

}  // namespace waymark
