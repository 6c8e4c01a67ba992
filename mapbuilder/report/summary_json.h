#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "mapbuilder/report/report.h"

namespace waymark {

/// Version of summary.json (docs/report.md). A key never changes its meaning or unit under it.
inline constexpr int kSummarySchema = 2;

/// The content of summary.json. Bytes of names that are no UTF-8 become U+FFFD. Who includes this
/// links nlohmann_json.
[[nodiscard]] nlohmann::ordered_json summary_json(const Report& report);

/// The same as text, indented, with a new line at the end.
[[nodiscard]] std::string format_summary(const Report& report);

/// JSON as text; bytes that are no UTF-8 become U+FFFD. `indent` as nlohmann's dump.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace waymark
