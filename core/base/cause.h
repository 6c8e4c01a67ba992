#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace waymark {

/// Why a result can't be trusted, or not fully: a closed list. The names (name_of) stand in
/// messages `SEVERITY [cause] subject: text` and in summary.json and never change their meaning;
/// new ones are appended to their group. docs/findings.md is made of the table behind them.
enum class Cause {
  // Input
  stamps,
  csv,
  format,
  family,
  unlisted_ids,
  mirrored,
  inverted_print,
  border,
  margin,
  dark,
  blind_camera,
  // Time
  clock,
  frame_order,
  // Rig
  rig_inverted,
  rig_unit,
  rig_turned,
  rig_exchanged,
  rig_displaced,
  rig_bumped,
  // Lens
  intrinsics,
  resolution,
  crop,
  rectified,
  images_turned,
  response,
  // Size
  size_scale,
  size,
  print_not_square,
  // Markers
  wrong_id,
  twin,
  moved,
  moving_group,
  riding,
  few_views,
  // Map
  disconnected,
  other_place,
  map_misfit,
  map_entry,
  not_level,
  scale_unknown,
  // Survey
  survey_unit,
  survey_mirrored,
  survey_entry,
  survey_corner,
};

/// What stands in docs/findings.md of a cause.
struct CauseText {
  Cause cause;
  std::string_view name;
  std::string_view about;   ///< its group: input, time, rig, lens, size, markers, map, survey
  std::string_view means;   ///< what is the matter
  std::string_view told;    ///< what gives it away
  std::string_view remedy;  ///< what to do, what is easiest to check first
};

/// All causes in the order of the enumeration.
[[nodiscard]] std::span<const CauseText> all_causes();

[[nodiscard]] const CauseText& text_of(Cause cause);

/// "rig_inverted": as written above.
[[nodiscard]] inline std::string_view name_of(Cause cause) { return text_of(cause).name; }

/// nullopt for an unknown name.
[[nodiscard]] std::optional<Cause> cause_from_name(std::string_view name);

}  // namespace waymark
