#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/map/marker_map.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// Why a marker is not used.
enum class QuarantineState : std::int8_t {
  moved = 0,    ///< MOVED: of the map, hangs elsewhere
  unknown = 1,  ///< UNKNOWN: hangs there, the map lacks it
  ignored = 2,  ///< IGNORED: somebody has told locd to leave it out, in whatever map
};

/// A marker that is not what the map says, or is ignored.
struct QuarantinedMarker {
  MarkerId marker;
  QuarantineState state = QuarantineState::moved;
  std::int64_t since_utime = 0;  ///< µs since the epoch when it was found; 0: the clock was not set
  double offset_m = 0;           ///< from where the map says; 0 of others than moved ones
};

/// quarantine.json: {"map_hash": "…", "markers": [{"id", "family", "state": "MOVED" | "UNKNOWN" |
/// "IGNORED", "since_utime", "offset_m"}]}, by rising id. Belongs to the map of that hash alone,
/// its ignored markers apart.
struct Quarantine {
  std::string map_hash;
  std::vector<QuarantinedMarker> markers;
};

/// Reads it. no_input when absent; bad_data for anything else than that form: unknown members (of a
/// newer version), values of another kind or out of range, a marker twice, more than 1 MB.
[[nodiscard]] Expected<Quarantine> read_quarantine(const std::filesystem::path& path);

/// The same, for whom none need be there: nullopt when absent, and only then.
[[nodiscard]] Expected<std::optional<Quarantine>> read_quarantine_if_any(
    const std::filesystem::path& path);

/// The same from text; `name` stands for the path in messages.
[[nodiscard]] Expected<Quarantine> parse_quarantine(std::string_view text, const std::string& name);

/// The same, and it must belong to `map` (read from `map_path`): bad_data, naming both, when a
/// vehicle made it against another.
[[nodiscard]] Expected<Quarantine> read_quarantine_of(const std::filesystem::path& path,
                                                      const MarkerMap& map,
                                                      const std::filesystem::path& map_path);

/// Writes atomically. Errors of write_file_atomically.
[[nodiscard]] Status write_quarantine(const std::filesystem::path& path,
                                      const Quarantine& quarantine);

}  // namespace waymark
