#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/calibrate/rig_calibration.h"
#include "mapbuilder/commands/captures_in.h"
#include "mapbuilder/commands/told_findings.h"

namespace waymark {

/// `mapbuilder calibrate CAPTURE... -o rig.yaml [--model
/// auto|none|radtan|rational|equidistant|eucm|ds] [--report DIR] [--redetect] [--detector NAME]
/// [--threads N] [--strict] [--accept-errors]`
struct CalibrateCommandOptions {
  CaptureInput input;  ///< no rig file needed; videos are none
  std::filesystem::path output;
  std::optional<std::filesystem::path> report;  ///< folder for summary.json and a page
  RigCalibrationOptions calibration;
  FindingRules rules;
};

/// Calibrates a rig from captures (calibrate_rig), in images twice: as straight lenses show
/// markers, then as those found do. Writes the rig file; what was found goes to `out`, camera by
/// camera with where its image is covered and what is missing; findings and notes to `notes`.
/// Errors: of input; bad_data where the images do not tell the rig, or an error stands against it:
/// the rig then goes to OUTPUT.rejected; an existing OUTPUT of the same cameras that fits the
/// captures better is such an error. Nothing that is read is overwritten.
[[nodiscard]] Status run_calibrate(const CalibrateCommandOptions& options, Progress& progress,
                                   std::ostream& out, std::ostream& notes);

}  // namespace waymark
