#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/map/marker_map.h"

namespace waymark {

/// JSON form of a map with all its sub-maps, one line per marker, numbers so that they read back to
/// the same bits:
///
///     {"schema": 1, "builder_version", "content_hash", "rig_fingerprint",
///      "capture_fingerprints": [], "submaps": [{"frame": "arbitrary" | "scaled" | "facility",
///        "z_is_up", "frame_sets", "rms_px", "rms_all_px", where anything is considered
///        "parameters": [{"name", "serial", "cross": [16]}], "parameter_covariance": [lower
///        triangle, row by row], "markers": [{"id": 12, or "tag36h11:12" where several families
///          meet; "family", "size_m", "stated_size_m", "position_m": [x, y, z],
///          "quaternion_xyzw": [x, y, z, w], "covariance" (within the map) and "covariance_metric":
///          [36, row-major] or null where unknown, where considered "modes": [6 × 16, row-major],
///          "observations", "rejected", "rms_px", "verified"}]}]}
///
/// `map` must be one that check_map accepts (checked).
[[nodiscard]] std::string format_map_json(const MarkerMap& map);

/// Reads that form, or a map measured by hand: only schema, submaps, markers, id, family, size_m,
/// position_m and quaternion_xyzw must be there. In a covariance's place "sigma_m" and "sigma_deg"
/// may say how sure each coordinate, and the turn about each axis, was measured; without any of
/// them it is unknown. A covariance_metric that is the covariance, without modes, says no more.
/// Left out, counts and RMS are 0, the stated size is the size, the frame arbitrary, z up in the
/// facility frame alone, and a marker counts as verified, for somebody measured it. Quaternions are
/// normalized, sub-maps and markers sorted; content_hash is not read, for the content may have been
/// edited. `name` stands for the path in messages. bad_data, with the place in the file, for what
/// is no JSON, unknown keys, a newer schema, values of the wrong kind, and whatever check_map
/// refuses.
[[nodiscard]] Expected<MarkerMap> parse_map_json(std::string_view text, const std::string& name);

/// The same from a file. Errors of read_file besides.
[[nodiscard]] Expected<MarkerMap> read_map_json(const std::filesystem::path& path);

/// Larger is no such file: as much as the largest map file.
inline constexpr std::size_t kMaxMapJsonBytes = std::size_t{1} << 28;

/// "arbitrary", "scaled", "facility".
[[nodiscard]] std::string_view name_of(FrameKind frame);

}  // namespace waymark
