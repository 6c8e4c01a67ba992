#pragma once

#include <string>
#include <vector>

#include "mapbuilder/upkeep/map_difference.h"

namespace waymark {

/// What a vehicle notices that is given the new map in place of the old, in plain words, a line
/// each; empty where the maps are the same.
[[nodiscard]] std::vector<std::string> what_a_vehicle_notices(const MapDifference& difference);

/// For people: the sub-maps that were compared, by which markers; what moved, appeared, vanished,
/// was renamed or has another size; what a vehicle notices.
[[nodiscard]] std::string format_difference_text(const MapDifference& difference);

/// For programs; lengths in m to the nm:
///
///     {"schema": 1, "same", "old": {"content_hash", "markers", "submaps"}, "new": {…},
///      "submaps": [{"old", "new", "common", "stayed": [ids], "by_majority",
///        "old_from_new": {"translation_m": [x, y, z], "quaternion_xyzw": [x, y, z, w]},
///        "world_shift_m", "world_turn_deg", "scale": null | {"old_from_new", "sigma"},
///        "compared_at_scale", "frame": {"old", "new"}, "z_is_up": {"old", "new"},
///        "median_sigma_m": {"old", "new"}, "stayed_rms_m", "moved": [{"id", "distance_m",
///        "offset_m": [x, y, z], "sigma_m": null where unknown, "turn_deg"}]}],
///      "appeared": [ids], "vanished": [ids], "renamed": [{"from", "to"}],
///      "resized": [{"id", "old_m", "new_m"}], "verified": [ids], "unverified": [ids],
///      "not_compared": [ids], "vehicle": [texts]}
[[nodiscard]] std::string format_difference_json(const MapDifference& difference);

}  // namespace waymark
