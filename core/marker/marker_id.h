#pragma once

#include <compare>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/marker/family.h"

namespace waymark {

/// A marker's identity: the same number in two families is two markers. Ordered by family, then
/// number.
struct MarkerId {
  Family family = Family::aruco_4x4_1000;
  int number = 0;

  auto operator<=>(const MarkerId&) const = default;  // NOLINT(modernize-use-nullptr): false alarm
};

/// "12" when `with_family` is false, else "tag36h11:12".
[[nodiscard]] std::string format_marker_id(const MarkerId& id, bool with_family);

/// "12" (then `default_family` is meant; nullopt where several families meet: bad_data that asks
/// for the qualified form) or "tag36h11:12". bad_data for anything else, and for a number outside
/// the family.
[[nodiscard]] Expected<MarkerId> parse_marker_id(std::string_view text,
                                                 std::optional<Family> default_family);

}  // namespace waymark
