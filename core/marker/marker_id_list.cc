#include "core/marker/marker_id_list.h"

#include <algorithm>
#include <tuple>

#include "core/base/text_field.h"
#include "core/marker/id_range.h"

namespace waymark {
namespace {

struct FamilyRange {
  Family family;
  IdRange range;
};

/// The range of one part, such as "tag36h11:3-7".
Expected<FamilyRange> parse_part(std::string_view part, std::optional<Family> default_family) {
  std::optional<Family> family = default_family;
  std::string_view numbers = part;
  if (const auto colon = part.find(':'); colon != std::string_view::npos) {
    const std::string_view name = trimmed(part.substr(0, colon));
    numbers = part.substr(colon + 1);
    family = family_from_name(name);
    if (!family) return fail(ErrorKind::bad_data, "\"{}\": unknown family \"{}\"", part, name);
  }
  if (!family) {
    return fail(ErrorKind::bad_data,
                "\"{}\": several families meet here; write it with its family, as in "
                "\"tag36h11:12\"",
                part);
  }
  const auto ranges = parse_id_ranges(numbers, *family);
  if (!ranges) return tl::make_unexpected(ranges.error());
  return FamilyRange{*family, ranges->front()};
}

/// Rising, each once, however often the ranges overlap: none is walked twice.
std::vector<MarkerId> ids_of(std::vector<FamilyRange> ranges) {
  std::sort(ranges.begin(), ranges.end(), [](const FamilyRange& a, const FamilyRange& b) {
    return std::tie(a.family, a.range.first) < std::tie(b.family, b.range.first);
  });
  std::vector<MarkerId> ids;
  for (const auto& [family, range] : ranges) {
    const bool same = !ids.empty() && ids.back().family == family;
    int number = same ? std::max(range.first, ids.back().number + 1) : range.first;
    for (; number <= range.last; ++number) ids.push_back({family, number});
  }
  return ids;
}

}  // namespace

Expected<std::vector<MarkerId>> parse_marker_ids(std::string_view text,
                                                 std::optional<Family> default_family) {
  std::vector<FamilyRange> ranges;
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto end = std::min(text.find(',', begin), text.size());
    const auto part = parse_part(trimmed(text.substr(begin, end - begin)), default_family);
    if (!part) return tl::make_unexpected(part.error());
    ranges.push_back(*part);
    begin = end + 1;
  }
  return ids_of(std::move(ranges));
}

std::string format_marker_ids(std::span<const MarkerId> ids, bool with_family, std::size_t most) {
  std::string text;
  std::size_t parts = 0;
  for (std::size_t i = 0; i < ids.size();) {
    if (parts == most) return text + fmt::format(", … ({} in all)", ids.size());
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1].family == ids[i].family &&
           ids[last + 1].number == ids[last].number + 1) {
      ++last;
    }
    if (!text.empty()) text += ", ";
    text += format_marker_id(ids[i], with_family);
    if (last > i) text += fmt::format("-{}", ids[last].number);
    ++parts;
    i = last + 1;
  }
  return text;
}

}  // namespace waymark
