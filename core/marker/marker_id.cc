#include "core/marker/marker_id.h"

#include <charconv>

namespace waymark {
namespace {

/// A non-negative decimal number that fills the whole text.
std::optional<int> parse_number(std::string_view text) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto [parsed_to, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || parsed_to != end || text.front() == '-') return std::nullopt;
  return number;
}

}  // namespace

std::string format_marker_id(const MarkerId& id, bool with_family) {
  return with_family ? fmt::format("{}:{}", name_of(id.family), id.number)
                     : fmt::format("{}", id.number);
}

Expected<MarkerId> parse_marker_id(std::string_view text, std::optional<Family> default_family) {
  std::optional<Family> family = default_family;
  std::string_view number_text = text;
  if (const auto colon = text.find(':'); colon != std::string_view::npos) {
    const std::string_view family_text = text.substr(0, colon);
    number_text = text.substr(colon + 1);
    family = family_from_name(family_text);
    if (!family) {
      return fail(ErrorKind::bad_data, "marker id \"{}\": unknown family \"{}\"", text,
                  family_text);
    }
  }
  const std::optional<int> number = parse_number(number_text);
  if (!number) {
    return fail(ErrorKind::bad_data,
                "marker id \"{}\": not a number; write \"12\" or \"tag36h11:12\"", text);
  }
  if (!family) {
    return fail(ErrorKind::bad_data,
                "marker id \"{}\": several families meet here; write it with its family, as in "
                "\"tag36h11:12\"",
                text);
  }
  if (*number >= traits(*family).id_count) {
    return fail(ErrorKind::bad_data, "marker id \"{}\": {} has the ids 0 to {} only", text,
                name_of(*family), traits(*family).id_count - 1);
  }
  return MarkerId{*family, *number};
}

}  // namespace waymark
