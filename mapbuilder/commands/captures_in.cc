#include "mapbuilder/commands/captures_in.h"

#include <fmt/ostream.h>

#include <algorithm>

#include "core/base/notes.h"
#include "core/base/output_check.h"
#include "core/camera/rig_parameters.h"
#include "core/capture/capture_files.h"
#include "mapbuilder/commands/print_line.h"
#include "mapbuilder/diagnosis/input_findings.h"
#include "mapbuilder/import/open_capture.h"
#include "mapbuilder/import/recorded_file.h"
#include "mapbuilder/observations/edge_correction.h"
#include "mapbuilder/observations/logged_capture.h"

namespace waymark {
namespace {

void print_notes(const std::vector<std::string>& lines, std::ostream& notes) {
  for (const std::string& line : shown_notes(lines)) fmt::print(notes, "{}\n", note_line(line));
}

/// What was measured of each camera's edges; nothing of one whose rig file states them.
void tell_edges(const DetectionReport& report, const Rig& rig, std::ostream& notes) {
  for (std::size_t i = 0; i < report.edges.size(); ++i) {
    if (states_edges(rig.cameras[i])) continue;
    print_line(notes, "{}", edges_text(rig.cameras[i].name, report.edges[i]));
  }
}

/// Which sigmas are taken where a capture's rig states none; told of the first such rig alone.
void tell_default_sigmas(const std::vector<DetectedCapture>& captures, std::ostream& notes) {
  for (const DetectedCapture& capture : captures) {
    if (const auto note = note_of_default_sigmas(capture.rig, capture.name)) {
      print_line(notes, "note: {}", *note);
      return;
    }
  }
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

void print_report(const std::string& name, const DetectionReport& report, std::ostream& notes) {
  print_notes(report.warnings, notes);
  print_line(notes, "{}: {} images{}, {} markers found{}", name, report.images,
             report.unreadable > 0 ? fmt::format(" ({} skipped)", report.unreadable) : "",
             report.detections, report.from_csv ? " (from detections.csv)" : "");
}

/// A capture of which no image is kept, with what its detections say by themselves.
void add_without_images(DetectedCapture capture, TakenCaptures& taken) {
  std::vector<CameraLook> looks;
  for (const RigCamera& camera : capture.rig.cameras) looks.emplace_back().camera = camera.name;
  for (Finding& finding : input_findings(capture, looks)) {
    taken.findings.push_back(std::move(finding));
  }
  taken.captures.push_back(std::move(capture));
}

Expected<TakenCaptures> take_videos_in(const CaptureInput& input, Progress& progress,
                                       std::ostream& notes) {
  DetectionReport report;
  auto detected = detect_videos({input.paths, *input.rig_yaml, *input.markers_toml, input.video},
                                input.detect, progress, report);
  if (!detected) return tl::make_unexpected(detected.error());
  print_report(detected->name, report, notes);
  TakenCaptures taken;
  add_without_images(std::move(*detected), taken);
  tell_default_sigmas(taken.captures, notes);
  return taken;
}

Expected<bool> is_log(const std::filesystem::path& path) {
  if (!is_file(path)) return false;
  const auto kind = kind_of_file(path);
  if (!kind) return tl::make_unexpected(kind.error());
  return *kind == RecordedFile::lcm_log;
}

/// Whether the paths are logs of locd's detections, each a capture of its own.
Expected<bool> are_logs(const std::vector<std::filesystem::path>& paths) {
  std::size_t logs = 0;
  for (const auto& path : paths) {
    const auto one = is_log(path);
    if (!one) return one;
    logs += *one ? 1 : 0;
  }
  if (logs == 0 || logs == paths.size()) return logs > 0;
  return fail(ErrorKind::usage,
              "{}: logs of detections and other captures at once; make captures of the logs by "
              "mapbuilder import",
              paths.front().string());
}

Expected<TakenCaptures> take_logs_in(const CaptureInput& input, Progress& progress,
                                     std::ostream& notes) {
  TakenCaptures taken;
  for (const auto& path : input.paths) {
    DetectionReport report;
    auto detected =
        take_logged_capture({path, *input.rig_yaml, *input.markers_toml}, progress, report);
    if (!detected) return tl::make_unexpected(detected.error());
    print_report(detected->name, report, notes);
    add_without_images(std::move(*detected), taken);
  }
  tell_default_sigmas(taken.captures, notes);
  return taken;
}

/// Videos, or logs: what brings neither rig nor markers along.
Expected<TakenCaptures> take_files_in(const CaptureInput& input, Progress& progress,
                                      std::ostream& notes) {
  if (!input.rig_yaml || !input.markers_toml) {
    return fail(ErrorKind::usage,
                "{}: a video or a log needs both --rig and --markers; a capture is a folder",
                std::find_if(input.paths.begin(), input.paths.end() - 1, is_file)->string());
  }
  const auto logs = are_logs(input.paths);
  if (!logs) return tl::make_unexpected(logs.error());
  return *logs ? take_logs_in(input, progress, notes) : take_videos_in(input, progress, notes);
}

}  // namespace

Status check_spares_input(const std::filesystem::path& output, const CaptureInput& input,
                          const std::vector<std::optional<std::filesystem::path>>& others,
                          const char* remedy) {
  std::vector<std::filesystem::path> files;
  for (const auto& file : {input.rig_yaml, input.markers_toml}) {
    if (file) files.push_back(*file);
  }
  for (const auto& file : others) {
    if (file) files.push_back(*file);
  }
  if (auto spares = check_spares(output, files, remedy); !spares) return spares;
  return check_spares_captures(output, input.paths, remedy);
}

Expected<TakenCaptures> take_captures_in(const CaptureInput& input, Progress& progress,
                                         std::ostream& notes) {
  if (input.rig_yaml || input.markers_toml ||
      std::any_of(input.paths.begin(), input.paths.end(), is_file)) {
    return take_files_in(input, progress, notes);
  }
  // All are opened before the first is searched: what is wrong shows before the long work.
  std::vector<CaptureFolder> folders;
  for (const auto& path : input.paths) {
    auto folder = open_capture(path, input.rig_file);
    if (!folder) return tl::make_unexpected(folder.error());
    print_notes(folder->notes, notes);
    if (folder->survey_toml && input.survey_not_asked) {
      print_line(notes, "note: {0}: used only when asked for: --survey {0}",
                 folder->survey_toml->string());
    }
    if (input.known_rig) {
      const auto count = static_cast<std::ptrdiff_t>(folder->rig.cameras.size());
      folder->rig = *input.known_rig;
      folder->rig.cameras.erase(folder->rig.cameras.begin() + count, folder->rig.cameras.end());
    }
    folders.push_back(std::move(*folder));
  }
  TakenCaptures taken;
  for (const CaptureFolder& folder : folders) {
    DetectionReport report;
    auto detected = detect_capture(folder, input.detect, progress, report);
    if (!detected) return tl::make_unexpected(detected.error());
    print_report(folder.path.string(), report, notes);
    tell_edges(report, detected->rig, notes);
    const auto looks = look_at_images(folder, *detected, input.detect.threads, progress);
    for (Finding& finding : input_findings(*detected, looks)) {
      taken.findings.push_back(std::move(finding));
    }
    taken.captures.push_back(std::move(*detected));
  }
  if (input.rig_file == RigFile::required) tell_default_sigmas(taken.captures, notes);
  return taken;
}

Status check_any_seen(const Observations& observations, const std::filesystem::path& capture) {
  if (observations.any_seen()) return {};
  return fail(
      ErrorKind::bad_data,
      "{}: {} frame sets show no marker that could be used; check the family and the ids in "
      "markers.toml",
      capture.string(), observations.frame_sets.size());
}

}  // namespace waymark
