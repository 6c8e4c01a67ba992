#include "mapbuilder/commands/captures_in.h"

#include <fmt/ostream.h>
#include <unistd.h>

namespace waymark {
namespace {

constexpr std::size_t kMostWarnings = 20;

void print_notes(const std::vector<std::string>& lines, std::ostream& notes) {
  for (std::size_t i = 0; i < std::min(lines.size(), kMostWarnings); ++i) {
    fmt::print(notes, "note: {}\n", lines[i]);
  }
  if (lines.size() > kMostWarnings) {
    fmt::print(notes, "note: … and {} more like these\n", lines.size() - kMostWarnings);
  }
}

}  // namespace

Expected<std::vector<DetectedCapture>> take_captures_in(
    const std::vector<std::filesystem::path>& paths, const DetectCaptureOptions& options,
    Progress& progress, std::ostream& notes) {
  std::vector<DetectedCapture> captures;
  for (const auto& path : paths) {
    const auto folder = open_capture_folder(path);
    if (!folder) return tl::make_unexpected(folder.error());
    print_notes(folder->notes, notes);
    DetectionReport report;
    auto detected = detect_capture(*folder, options, progress, report);
    if (!detected) return tl::make_unexpected(detected.error());
    print_notes(report.warnings, notes);
    fmt::print(notes, "{}: {} images{}, {} markers found{}\n", path.string(), report.images,
               report.unreadable > 0 ? fmt::format(" ({} skipped)", report.unreadable) : "",
               report.detections, report.from_csv ? " (from detections.csv)" : "");
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

}  // namespace waymark
