#pragma once

#include <optional>
#include <string_view>

namespace waymark {

/// A run of ids, both ends included.
struct IdRange {
  int first;
  int last;
};

/// "100" or "100-199", blanks allowed around numbers; nullopt for anything else, and for a range
/// that falls.
[[nodiscard]] std::optional<IdRange> parse_id_range(std::string_view text);

}  // namespace waymark
