#pragma once

#include <filesystem>
#include <optional>
#include <ostream>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "mapbuilder/build/build_options.h"
#include "mapbuilder/commands/captures_in.h"
#include "mapbuilder/commands/told_findings.h"

namespace waymark {

/// `mapbuilder update OLD.map CAPTURE... -o NEW.map [--quarantine FILE] [--drop-unseen]
/// [--report DIR] [--strict] [--accept-errors] [--threads N]`
struct UpdateCommandOptions {
  std::filesystem::path old_map;
  CaptureInput input;
  std::filesystem::path output;                     ///< may be the old map itself
  std::optional<std::filesystem::path> quarantine;  ///< of a vehicle that used the old map
  std::optional<std::filesystem::path> report;      ///< folder for summary.json and a page
  bool drop_unseen = false;
  FindingRules rules;
  BuildOptions build;
};

/// Brings a map up to date by captures that see some of it (update_map): they are built and
/// diagnosed as `build` does, laid into the old map's world and adjusted together with it. What
/// became of the markers goes to `out`, findings and notes to `notes`. Errors: those of reading and
/// of build; bad_data where the captures can't be laid into the map, where one of them is in it
/// already, and where an error stands against the result, which then goes to NEW.map.rejected.
/// Whatever fails, what stood in NEW.map's place stays.
[[nodiscard]] Status run_update(const UpdateCommandOptions& options, Progress& progress,
                                std::ostream& out, std::ostream& notes);

}  // namespace waymark
