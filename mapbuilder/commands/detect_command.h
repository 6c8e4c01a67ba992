#pragma once

#include <filesystem>
#include <optional>
#include <ostream>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/commands/told_findings.h"
#include "mapbuilder/referees/detector_engine.h"

namespace waymark {

/// `mapbuilder detect CAPTURE [-o DETECTIONS.csv] [--correct-edges]
/// [--detector own|opencv|apriltag]`, or `mapbuilder detect LCMLOG --rig RIG --markers MARKERS -o
/// DETECTIONS.csv`
struct DetectOptions {
  std::filesystem::path capture;
  std::optional<std::filesystem::path> output;   ///< default: detections.csv in the capture
  std::optional<std::filesystem::path> rig;      ///< for a log of locd's detections
  std::optional<std::filesystem::path> markers;  ///< likewise
  int threads = 0;
  bool correct_edges = true;                    ///< as in DetectCaptureOptions
  DetectorEngine engine = DetectorEngine::own;  ///< likewise
  FindingRules rules;
};

/// Detects the markers in a capture's images, even where a detections.csv lies beside them, and
/// writes them as CSV. Errors of detect_capture and write_file_atomically; usage when the capture
/// has no images, and for a log without rig, markers and output; bad_data, and nothing is written,
/// where an error stands against them.
[[nodiscard]] Status run_detect(const DetectOptions& options, Progress& progress, std::ostream& out,
                                std::ostream& notes);

}  // namespace waymark
