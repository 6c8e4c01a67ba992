#include "core/marker/id_range.h"

#include <algorithm>

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

Expected<std::vector<IdRange>> parse_id_ranges(std::string_view text, Family family) {
  std::vector<IdRange> ranges;
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto end = std::min(text.find(',', begin), text.size());
    const std::string_view part = trimmed(text.substr(begin, end - begin));
    const auto range = parse_id_range(part);
    if (!range) {
      return fail(ErrorKind::bad_data, "\"{}\" is no id and no range such as \"100-199\"", part);
    }
    if (range->last >= traits(family).id_count) {
      return fail(ErrorKind::bad_data, "id {}: {} has the ids 0 to {} only", range->last,
                  name_of(family), traits(family).id_count - 1);
    }
    ranges.push_back(*range);
    begin = end + 1;
  }
  return ranges;
}

std::string format_id_ranges(std::span<const int> ids) {
  std::string text;
  for (std::size_t i = 0; i < ids.size();) {
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1) ++last;
    if (!text.empty()) text += ", ";
    text += last == i ? fmt::format("{}", ids[i]) : fmt::format("{}-{}", ids[i], ids[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace waymark
