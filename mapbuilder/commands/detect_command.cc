#include "mapbuilder/commands/detect_command.h"

#include <fmt/ostream.h>

#include "core/base/atomic_file.h"
#include "core/capture/detections_csv.h"
#include "mapbuilder/commands/captures_in.h"

namespace waymark {

Status run_detect(const DetectOptions& options, Progress& progress, std::ostream& out,
                  std::ostream& notes) {
  const auto output = options.output.value_or(options.capture / "detections.csv");
  if (std::error_code ignored; std::filesystem::exists(options.capture, ignored)) {
    if (auto writable = check_writable(output); !writable) return writable;
  }
  DetectCaptureOptions detect;
  detect.redetect = true;
  detect.threads = options.threads;
  const auto captures = take_captures_in({{options.capture}, {}, {}, {}, detect}, progress, notes);
  if (!captures) return tl::make_unexpected(captures.error());
  const DetectedCapture& capture = captures->front();
  const std::string text =
      format_detections_csv(capture.images, capture.rig, capture.catalog, detector_name());
  if (auto written = write_file_atomically(output, text); !written) return written;
  std::size_t markers = 0;
  for (const ImageDetections& image : capture.images) markers += image.detections.size();
  fmt::print(out, "{}: {} markers in {} images\n", output.string(), markers, capture.images.size());
  return {};
}

}  // namespace waymark
