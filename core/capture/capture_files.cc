#include "core/capture/capture_files.h"

#include <algorithm>
#include <array>
#include <string>
#include <system_error>

#include "core/base/folder_walk.h"
#include "core/base/same_file.h"
#include "core/base/text_field.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDetections = "detections.csv";

constexpr std::array kNamedFiles{"rig.yaml",   "markers.toml",  "capture.toml",
                                 "frames.csv", "survey.toml",   "sfm.toml",
                                 "calib.json", "marker_gt.txt", "cam_gt.txt"};

bool is_folder_of_capture(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name == "images" || name == "groundtruth" || is_camera_folder_name(name);
}

/// Whether a file of the folder, however deep, is that at `path` under another name.
bool is_linked_from(const fs::path& folder, const fs::path& path) {
  bool linked = false;
  walk_folder<fs::recursive_directory_iterator>(folder, [&](const fs::directory_entry& entry) {
    std::error_code unknown;
    linked = linked || fs::equivalent(entry.path(), path, unknown);
  });
  return linked;
}

/// Whether the path lies in one of the capture's folders in `parent`, or is linked from there.
bool is_in_folders_of(const fs::path& parent, const fs::path& path) {
  std::error_code ignored;
  const bool exists = fs::exists(path, ignored);
  bool within = false;
  walk_folder<fs::directory_iterator>(parent, [&](const fs::directory_entry& entry) {
    if (within || !is_folder_of_capture(entry.path())) return;
    within = is_within(path, entry.path()) || (exists && is_linked_from(entry.path(), path));
  });
  return within;
}

}  // namespace

bool is_camera_folder_name(std::string_view name) {
  constexpr std::string_view kPrefix = "cam";
  return name.starts_with(kPrefix) && parse_whole<unsigned>(name.substr(kPrefix.size()));
}

bool is_capture_file(const fs::path& path, const fs::path& capture, CaptureDetections detections) {
  const auto is_named = [&](const char* name) { return is_same_file(path, capture / name); };
  if (is_same_file(path, capture) ||
      std::any_of(kNamedFiles.begin(), kNamedFiles.end(), is_named)) {
    return true;
  }
  if (detections == CaptureDetections::kept && is_named(kDetections)) return true;
  // A folder images may hold the camera folders, which may be links themselves.
  return is_in_folders_of(capture, path) || is_in_folders_of(capture / "images", path);
}

Status check_spares_captures(const fs::path& output, const std::vector<fs::path>& captures,
                             const char* remedy, CaptureDetections detections) {
  for (const fs::path& capture : captures) {
    if (!is_capture_file(output, capture, detections)) continue;
    return fail(ErrorKind::usage, "{}: is or would be a file of the capture {}, which is read; {}",
                output.string(), capture.string(), remedy);
  }
  return {};
}

}  // namespace waymark
