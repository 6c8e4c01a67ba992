#include "mapbuilder/commands/captures_in.h"

#include <fmt/ostream.h>
#include <unistd.h>

#include <algorithm>

#include "core/base/notes.h"
#include "mapbuilder/import/open_capture.h"

namespace waymark {
namespace {

void print_notes(const std::vector<std::string>& lines, std::ostream& notes) {
  for (const std::string& line : shown_notes(lines)) fmt::print(notes, "note: {}\n", line);
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

void print_report(const std::string& name, const DetectionReport& report, std::ostream& notes) {
  print_notes(report.warnings, notes);
  fmt::print(notes, "{}: {} images{}, {} markers found{}\n", name, report.images,
             report.unreadable > 0 ? fmt::format(" ({} skipped)", report.unreadable) : "",
             report.detections, report.from_csv ? " (from detections.csv)" : "");
}

Expected<std::vector<DetectedCapture>> take_videos_in(const CaptureInput& input, Progress& progress,
                                                      std::ostream& notes) {
  if (!input.rig_yaml || !input.markers_toml) {
    return fail(ErrorKind::usage,
                "{}: a video needs both --rig and --markers; a capture is a folder",
                std::find_if(input.paths.begin(), input.paths.end() - 1, is_file)->string());
  }
  DetectionReport report;
  auto detected = detect_videos({input.paths, *input.rig_yaml, *input.markers_toml, input.video},
                                input.detect.threads, progress, report);
  if (!detected) return tl::make_unexpected(detected.error());
  print_report(detected->name, report, notes);
  std::vector<DetectedCapture> captures;
  captures.push_back(std::move(*detected));
  return captures;
}

}  // namespace

Expected<std::vector<DetectedCapture>> take_captures_in(const CaptureInput& input,
                                                        Progress& progress, std::ostream& notes) {
  if (input.rig_yaml || input.markers_toml ||
      std::any_of(input.paths.begin(), input.paths.end(), is_file)) {
    return take_videos_in(input, progress, notes);
  }
  // All are opened before the first is searched: what is wrong shows before the long work.
  std::vector<CaptureFolder> folders;
  for (const auto& path : input.paths) {
    auto folder = open_capture(path);
    if (!folder) return tl::make_unexpected(folder.error());
    print_notes(folder->notes, notes);
    if (folder->survey_toml && !input.survey_given) {
      fmt::print(notes, "note: {0}: used only when asked for: --survey {0}\n",
                 folder->survey_toml->string());
    }
    folders.push_back(std::move(*folder));
  }
  std::vector<DetectedCapture> captures;
  for (const CaptureFolder& folder : folders) {
    DetectionReport report;
    auto detected = detect_capture(folder, input.detect, progress, report);
    if (!detected) return tl::make_unexpected(detected.error());
    print_report(folder.path.string(), report, notes);
    captures.push_back(std::move(*detected));
  }
  return captures;
}

Status check_writable(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return fail(ErrorKind::cant_create, "{}: can't write: it is a folder; name a file",
                path.string());
  }
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, ignored)) {
    return fail(ErrorKind::cant_create, "{}: can't write: the folder {} does not exist; create it",
                path.string(), folder.string());
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    return fail(ErrorKind::permission, "{}: can't write: no permission in the folder {}",
                path.string(), folder.string());
  }
  return {};
}

void print_table_notes(const ObservationTable& table, std::ostream& notes) {
  if (table.repeated_in_image > 0) {
    fmt::print(notes,
               "warning: {} detections left out, their id was found twice in one image; is a "
               "marker printed twice?\n",
               table.repeated_in_image);
  }
  if (table.degenerate > 0) {
    fmt::print(notes, "note: {} detections left out, their corners are no view of a square\n",
               table.degenerate);
  }
}

}  // namespace waymark
