#pragma once

#include <string>

#include "mapbuilder/report/report.h"

namespace waymark {

/// The first bytes of every report page, by which a report is known again.
inline constexpr char kPageMark[] = "<!doctype html><!-- Waymark map report -->";

/// One self-contained HTML page: markup, style, script (page/, bundled at build time) and the
/// report's data inline. It asks for nothing from anywhere, which its content security policy
/// enforces, and no text of the report can become markup or script: it stands as JSON in a data
/// block without a single '<'.
[[nodiscard]] std::string format_report_page(const Report& report);

}  // namespace waymark
