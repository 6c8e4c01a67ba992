#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/commands/captures_in.h"
#include "mapbuilder/commands/told_findings.h"

namespace waymark {

/// `mapbuilder build CAPTURE... -o MAP [--trajectory RIG.tum] [--report DIR] [--mono] [--threads N]
/// [--survey FILE] [--refine extrinsics,intrinsics,sizes] [--refined-rig FILE]
/// [--frame-of MAP] [--quarantine FILE] [--level floor|walls] [--strict]
/// [--accept-errors]
/// [--redetect] [--loss huber|none] [--gate on|off] [--weight covariance|paper|none]`, or with
/// `VIDEO... --rig FILE --markers FILE [--every N] [--sync]` in the captures' place
struct BuildCommandOptions {
  CaptureInput input;
  std::filesystem::path output;
  std::optional<std::filesystem::path> trajectory;
  std::optional<std::filesystem::path> report;       ///< folder for summary.json and a page
  std::optional<std::filesystem::path> survey;       ///< survey.toml
  std::optional<std::filesystem::path> refined_rig;  ///< camchain to write; default beside the map
  std::optional<std::filesystem::path> frame_of;     ///< an earlier map whose world is kept
  std::optional<std::filesystem::path> quarantine;   ///< a vehicle's quarantine.json
  std::optional<LevelBy> level;                      ///< what makes z point up
  bool mono = false;
  FindingRules rules;
  BuildOptions build;
};

/// Builds a map from captures and writes it; a summary goes to `out`, findings and notes to
/// `notes`. Errors: bad input (see detect_capture, make_observations); bad_data when not one
/// marker could be mapped, and where an error stands against the map: it then goes to MAP.rejected,
/// the report is written, and what stood in MAP's, the trajectory's and the refined rig's places
/// stays; write errors. Nothing is written unless everything could be computed.
[[nodiscard]] Status run_build(const BuildCommandOptions& options, Progress& progress,
                               std::ostream& out, std::ostream& notes);

}  // namespace waymark
