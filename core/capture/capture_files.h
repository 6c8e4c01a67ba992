#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace waymark {

/// "cam" and a number: the name of a folder with a camera's images.
[[nodiscard]] bool is_camera_folder_name(std::string_view name);

/// What becomes of a capture's detections.csv.
enum class CaptureDetections {
  kept,
  replaced,  ///< they are what is made of the capture
};

/// Whether `path` is one of a capture's own files, or would become one, under any of its names: the
/// capture itself (a video), every file that Waymark's layout and the paper's know by name, and all
/// that lies in a folder camK, images or groundtruth or is linked from there. Folders that can't be
/// listed hold nothing.
[[nodiscard]] bool is_capture_file(const std::filesystem::path& path,
                                   const std::filesystem::path& capture,
                                   CaptureDetections detections = CaptureDetections::kept);

/// Fails (usage) when `output` would take the place of a file of one of the `captures`, or lie
/// among its images; `remedy` ends the line.
[[nodiscard]] Status check_spares_captures(const std::filesystem::path& output,
                                           const std::vector<std::filesystem::path>& captures,
                                           const char* remedy = "name another file",
                                           CaptureDetections detections = CaptureDetections::kept);

}  // namespace waymark
