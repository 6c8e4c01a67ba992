#pragma once

#include <filesystem>
#include <optional>
#include <ostream>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/commands/captures_in.h"
#include "mapbuilder/commands/told_findings.h"

namespace waymark {

/// `mapbuilder localize CAPTURE --map MAP --trajectory OUT.tum [--quarantine FILE]`, or with videos
/// as build takes them
struct LocalizeOptions {
  CaptureInput input;
  std::filesystem::path map;
  std::filesystem::path trajectory;
  std::optional<std::filesystem::path> quarantine;  ///< a vehicle's: moved markers take no part
  bool mono = false;
  BuildOptions build;
  FindingRules rules;
};

/// Localizes a capture against a finished map; writes the trajectory, prints a summary. Errors: bad
/// input, bad_data when the capture sees none of the map's markers, and, nothing written, where an
/// error stands against the result; write errors.
[[nodiscard]] Status run_localize(const LocalizeOptions& options, Progress& progress,
                                  std::ostream& out, std::ostream& notes);

}  // namespace waymark
