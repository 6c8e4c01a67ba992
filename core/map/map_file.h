#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/map/marker_map.h"

namespace waymark {

/// Newest version of the container and its records. A reader refuses newer ones.
inline constexpr std::uint32_t kMapContainerVersion = 3;

/// The binary map file: a container (little-endian)
///
///     8 bytes   magic "WAYMARK\n"
///     4 bytes   container version
///     8 bytes   length of the payload
///     4 bytes   CRC32C over the three fields above and the payload
///     payload   records of proto/: map_header_t, map_capture_t…, then per sub-map map_submap_t,
///               map_world_t, in version 3 map_parameters_t, map_parameter_t…,
///               map_parameter_covariance_t… and map_considered_marker_t…, else map_marker_t…; all
///               of fixed size, in LCM's own encoding (big-endian)
///
/// Version 1 had no map_world_t (z is up in the facility frame alone), and wrote covariances that
/// nobody knew as zero; it is read as such. A map that considers nothing beyond its markers' own
/// covariances is of version 2 and stays so, content hash and all.
///
/// The same map gives the same bytes; nothing in them depends on time or place.
///
/// Errors (internal): a map that check_map refuses, for it could not be read back.
[[nodiscard]] Expected<std::string> encode_map(const MarkerMap& map);

/// The map in `bytes`; `name` stands for the path in messages. bad_data, in one line, for: another
/// kind of file, a newer version, a truncated or damaged file (any flipped bit), counts that don't
/// fit the length, and whatever check_map refuses.
[[nodiscard]] Expected<MarkerMap> decode_map(std::string_view bytes, const std::string& name);

/// Encodes and writes atomically. Errors of both.
[[nodiscard]] Status write_map_file(const std::filesystem::path& path, const MarkerMap& map);

/// Reads and decodes. Errors of both; no_input when absent.
[[nodiscard]] Expected<MarkerMap> read_map_file(const std::filesystem::path& path);

/// Names a map by its content: 16 hexadecimal digits, the same for maps whose files are the same.
/// `map` must be one that check_map accepts (checked).
[[nodiscard]] std::string content_hash(const MarkerMap& map);

}  // namespace waymark
