#pragma once

#include <filesystem>
#include <optional>
#include <ostream>

#include "core/base/error.h"
#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/commands/build_command.h"
#include "mapbuilder/observations/observations.h"

namespace waymark {

/// Where the first rig goes that was asked for, be it that it is refined or where it is written:
/// as named, else MAP's name with .yaml; nullopt when none was.
[[nodiscard]] std::optional<std::filesystem::path> asked_rig_path(
    const BuildCommandOptions& options);

/// A rig as the build has refined it, with what its captures' images tell of its edges:
/// edge_bias_px, its sigma and, where it is not stated, the response.
[[nodiscard]] Rig improved_rig(RigIndex rig, const Calibration& calibration,
                               const Observations& observations);

/// Writes rigs that were refined, or whose edges were measured, as camchains, numbered from the
/// second on. One that nobody asked for goes beside the map (MAP.yaml), but into no input's place
/// and into none of a file that no build wrote or that somebody changed since (its first line tells
/// that): `notes` then says how to name another.
[[nodiscard]] Status write_improved_rigs(const BuildCommandOptions& options,
                                         const BuildResult& result,
                                         const Observations& observations, std::ostream& out,
                                         std::ostream& notes);

}  // namespace waymark
