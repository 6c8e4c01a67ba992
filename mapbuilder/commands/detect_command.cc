#include "mapbuilder/commands/detect_command.h"

#include <fmt/ostream.h>

#include "core/base/atomic_file.h"
#include "core/base/output_check.h"
#include "core/capture/capture_files.h"
#include "core/capture/detections_csv_text.h"
#include "mapbuilder/commands/captures_in.h"
#include "mapbuilder/commands/print_line.h"

namespace waymark {

Status run_detect(const DetectOptions& options, Progress& progress, std::ostream& out,
                  std::ostream& notes) {
  const auto output = options.output.value_or(options.capture / "detections.csv");
  const bool logged = options.rig || options.markers;
  if (logged && !options.output) {
    return fail(ErrorKind::usage, "{}: name by -o where its detections are to be written",
                options.capture.string());
  }
  if (std::error_code ignored; std::filesystem::exists(options.capture, ignored)) {
    if (auto writable = check_writable(output); !writable) return writable;
    auto spares = check_spares_captures(output, {options.capture}, "name another file",
                                        CaptureDetections::replaced);
    if (!spares) return spares;
  }
  DetectCaptureOptions detect;
  detect.redetect = true;
  detect.threads = options.threads;
  detect.correct_edges = options.correct_edges;
  detect.engine = options.engine;
  CaptureInput input;
  input.paths = {options.capture};
  input.rig_yaml = options.rig;
  input.markers_toml = options.markers;
  input.detect = detect;
  auto taken = take_captures_in(input, progress, notes);
  if (!taken) return tl::make_unexpected(taken.error());
  const auto findings = judged(std::move(taken->findings), options.rules);
  print_findings(findings, notes);
  if (!may_stand(findings, options.rules)) {
    return tl::make_unexpected(refusal_of(output.string(), findings, "nothing was written"));
  }
  const DetectedCapture& capture = taken->captures.front();
  const std::string text =
      format_detections_csv(capture.images, capture.rig, capture.catalog,
                            detector_name(options.engine), edge_moves(capture));
  if (auto written = write_file_atomically(output, text); !written) return written;
  std::size_t markers = 0;
  for (const ImageDetections& image : capture.images) markers += image.detections.size();
  print_line(out, "{}: {} markers in {} images", output.string(), markers, capture.images.size());
  return {};
}

}  // namespace waymark
