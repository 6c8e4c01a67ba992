#pragma once

#include "core/base/error.h"
#include "core/capture/capture_folder.h"
#include "mapbuilder/observation_table.h"
#include "mapbuilder/progress.h"

namespace waymark {

/// Where detections come from.
struct DetectCaptureOptions {
  bool redetect = false;  ///< detect in the images even where detections.csv lies beside them
  int threads = 0;        ///< 0 = all processors
};

/// What happened to a capture's images.
struct DetectionReport {
  bool from_csv = false;
  std::size_t images = 0;
  std::size_t unreadable = 0;
  std::vector<std::string> warnings;  ///< one line each, ready to print
};

/// A capture's detections, by its detections.csv or else from its images, each decoded, detected
/// and dropped. An unreadable image is skipped, counted and said; one of another size than rig.yaml
/// says, too. Errors: those of the CSV; bad_data when no image at all could be used.
[[nodiscard]] Expected<DetectedCapture> detect_capture(const CaptureFolder& capture,
                                                       const DetectCaptureOptions& options,
                                                       Progress& progress, DetectionReport& report);

}  // namespace waymark
