#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// One line of a TUM file: `key tx ty tz qx qy qz qw`. The key is a time in s or a marker's id and
/// is kept as text, because a double would round a time of today to 238 ns.
struct TumPose {
  std::string key;
  Rigid3 pose;  ///< world_from_rig or world_from_marker
};

/// Reads a TUM file: `#` comments, blanks and CRLF allowed, any white space between fields.
/// Quaternions are normalized; one whose norm is off by more than 1 %, a number that is none or
/// not finite, a position beyond 1000 km, or a line without 8 fields: bad_data with the line's
/// number. Absent file: no_input.
[[nodiscard]] Expected<std::vector<TumPose>> read_tum(const std::filesystem::path& path);

/// The same from text; `name` stands for the path in messages.
[[nodiscard]] Expected<std::vector<TumPose>> parse_tum(std::string_view text,
                                                       const std::string& name);

/// Text of a TUM file with 9 decimals.
[[nodiscard]] std::string format_tum(const std::vector<TumPose>& poses);

/// Seconds with exactly 9 decimals as text ("1511000000.000000000"), and back; bad_data when the
/// text is no decimal number within ±9.2e9 s. Negative stamps work.
[[nodiscard]] std::string format_stamp_s(Stamp stamp);
[[nodiscard]] Expected<Stamp> parse_stamp_s(std::string_view text);

}  // namespace waymark
