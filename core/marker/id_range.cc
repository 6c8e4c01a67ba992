#include "core/marker/id_range.h"

#include "core/base/text_field.h"

namespace waymark {

std::optional<IdRange> parse_id_range(std::string_view text) {
  const auto dash = text.find('-');
  const auto first = parse_whole<int>(trimmed(text.substr(0, dash)));
  const auto last =
      dash == std::string_view::npos ? first : parse_whole<int>(trimmed(text.substr(dash + 1)));
  if (!first || !last || *first < 0 || *last < *first) return std::nullopt;
  return IdRange{*first, *last};
}

}  // namespace waymark
