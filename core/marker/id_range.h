#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/marker/family.h"

namespace waymark {

/// A run of ids, both ends included.
struct IdRange {
  int first;
  int last;
};

/// "100" or "100-199", blanks allowed around numbers; nullopt for anything else, and for a range
/// that falls.
[[nodiscard]] std::optional<IdRange> parse_id_range(std::string_view text);

/// "100-199, 205": ranges of ids of one family, in the text's order. bad_data, naming the part that
/// is at fault, for what is no range, and for an id that the family does not have.
[[nodiscard]] Expected<std::vector<IdRange>> parse_id_ranges(std::string_view text, Family family);

/// "3-7, 9" from rising ids.
[[nodiscard]] std::string format_id_ranges(std::span<const int> ids);

}  // namespace waymark
