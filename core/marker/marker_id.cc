#include "core/marker/marker_id.h"

#include "core/base/text_field.h"

namespace waymark {
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
  const auto number = parse_whole<int>(number_text);
  if (!number || *number < 0) {
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
