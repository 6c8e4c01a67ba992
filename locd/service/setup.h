#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/camera/rig.h"
#include "core/map/marker_map.h"
#include "locd/pose/localizer.h"
#include "locd/publish/message_key.h"
#include "locd/service/config.h"

namespace waymark {

/// Everything that locd.toml names, read and found to fit together: what --check checks, what a
/// start starts with and what a reload swaps in.
struct Setup {
  Config config;  ///< cameras by the rig's order
  Rig rig;        ///< read-out times as the configuration has them
  std::optional<MarkerMap> map;
  std::string map_hash;           ///< content hash; empty without a map
  std::optional<MessageKey> key;  ///< what poses are signed with
  std::vector<Family> inverted;   ///< printed white for black, as the same file says
  std::string markers_toml;       ///< for recordings; empty when nothing tells families and sizes
  std::vector<std::string> warnings;  ///< what should be mended
  std::vector<std::string> notes;     ///< what the user should know, what weighs most first
};

/// Reads configuration, rig, map and replayed captures. Errors: those of the readers; config for
/// [[camera]] blocks and rig cameras that don't match, more than kMaxCameras, several cameras
/// without transforms.
[[nodiscard]] Expected<Setup> load_setup(const std::filesystem::path& config);

/// The lines in which warnings ("warning: …") and notes are logged.
[[nodiscard]] std::vector<std::string> told_of(const Setup& setup);

/// Whether two rigs are the same in everything that cameras and localization depend on.
[[nodiscard]] bool same_rig(const Rig& a, const Rig& b);

/// The configuration in the localizer's terms.
[[nodiscard]] LocalizerOptions localizer_options(const Setup& setup);
[[nodiscard]] SyncOptions sync_options(const Config& config);
/// Per camera, what is taken off its stamps.
[[nodiscard]] std::vector<Stamp> stamp_delays(const Config& config);

}  // namespace waymark
