#include "core/map/json_value.h"

namespace waymark {

MarkerId read_marker_id(JsonFields& fields) {
  const std::string family_name = fields.text("family");
  const nlohmann::json* const value = fields.value("id");
  if (!fields.good()) return {};
  const auto family = family_from_name(family_name);
  if (!family) {
    fields.reject(fmt::format("unknown family \"{}\"", family_name));
    return {};
  }
  if (value == nullptr) {
    fields.reject("\"id\" is missing");
    return {};
  }
  if (!value->is_string() && !value->is_number_integer()) {
    fields.reject("id", "is neither a whole number nor a text");
    return {};
  }
  const auto id =
      parse_marker_id(value->is_string() ? value->get<std::string>() : value->dump(), *family);
  if (!id) {
    fields.reject("id", id.error().message);
    return {};
  }
  if (id->family != *family) {
    fields.reject("id", "the family is not the one under \"family\"");
    return {};
  }
  return *id;
}

}  // namespace waymark
