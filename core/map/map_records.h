#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/map/marker_map.h"

namespace waymark {

/// The version whose records hold all of a map: 3 where it considers anything, else 2.
[[nodiscard]] std::uint32_t record_version(const MarkerMap& map);

/// The payload of a map file of that version: the records of proto/ one after another. Canonical:
/// the same map gives the same bytes. `map` must be one that check_map accepts.
[[nodiscard]] std::string encode_records(const MarkerMap& map);

/// Back, from a file of container version `version` ≥ 1. Every count is held against the bytes left
/// before anything is allocated. bad_data for a record of another type, counts that don't fit,
/// numbers that are no family or kind of frame, and bytes left over. Says nothing yet about the
/// numbers' sense: see check_map.
[[nodiscard]] Expected<MarkerMap> decode_records(std::string_view payload, std::uint32_t version);

}  // namespace waymark
