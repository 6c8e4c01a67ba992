#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/capture/capture_folder.h"
#include "core/detect/edge_bias.h"
#include "core/detect/image_detector.h"
#include "mapbuilder/observations/detected_capture.h"
#include "mapbuilder/referees/detector_engine.h"

namespace waymark {

/// Where detections come from.
struct DetectCaptureOptions {
  bool redetect = false;  ///< detect in the images even where detections.csv lies beside them
  int threads = 0;        ///< 0 = all processors; never changes the result
  /// Measure how far edges are seen inside the black and move corners outward (edge_correction);
  /// of detections.csv, whose images are not read, corners stay as they are.
  bool correct_edges = true;
  DetectorEngine engine = DetectorEngine::own;  ///< who finds markers
};

/// What happened to a capture's images.
struct DetectionReport {
  bool from_csv = false;
  std::size_t images = 0;      ///< seen, whether or not something was found in them
  std::size_t unreadable = 0;  ///< skipped: damaged, or of another size than rig.yaml says
  std::size_t detections = 0;
  DetectionCounts counts;  ///< of images, not of a CSV
  /// Each camera's edges where they were asked for; nullopt: its markers do not tell.
  std::vector<std::optional<EdgeBias>> edges;
  std::vector<std::string> warnings;  ///< one line each, ready to print
};

/// Name of our detector, and of the engine in it, as it stands in the first line of a
/// detections.csv.
[[nodiscard]] std::string detector_name(DetectorEngine engine);

/// Makes a capture's sync tolerance one that pairs its images rightly (usable_tolerance), and tells
/// it.
void fit_sync_tolerance(DetectedCapture& capture, DetectionReport& report);

/// Image detectors for a catalog, one for each of `count` threads. Errors of make_detector; `name`
/// stands for catalog or capture there.
[[nodiscard]] Expected<std::vector<std::unique_ptr<ImageDetector>>> image_detectors(
    const MarkerCatalog& catalog, DetectorEngine engine, int count, const std::string& name);

/// A capture's detections: from its detections.csv or else from its images, each decoded, detected
/// and dropped, several at a time. An unreadable image is skipped, counted and said, as is one of
/// another size than rig.yaml says. Errors: those of the CSV; bad_data when not one image could be
/// used.
[[nodiscard]] Expected<DetectedCapture> detect_capture(const CaptureFolder& capture,
                                                       const DetectCaptureOptions& options,
                                                       Progress& progress, DetectionReport& report);

}  // namespace waymark
