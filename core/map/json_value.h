#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/json_fields.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// A marker's id in JSON: 12, or "tag36h11:12" where several families meet. A target
/// that includes this header links nlohmann_json.
[[nodiscard]] inline nlohmann::ordered_json json_of(const MarkerId& id, bool with_family) {
  if (with_family) return format_marker_id(id, true);
  return id.number;
}

/// The marker that "family" and "id" name; the id is a number, or a text such as "12" or
/// "tag36h11:12", whose family must be the other one.
[[nodiscard]] MarkerId read_marker_id(JsonFields& fields);

/// To 9 decimals (nm, 1e-9°), for results: finer digits are rounding, and differ between machines.
[[nodiscard]] inline double nine_decimals(double value) {
  return std::round(value * 1e9) / 1e9 + 0.0;  // + 0.0 turns -0 into 0
}

}  // namespace waymark
