#include "mapbuilder/diagnosis/finding.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/base/one_line.h"

namespace waymark {

std::string_view name_of(Severity severity) {
  constexpr std::array<std::string_view, 3> kNames{"error", "warning", "note"};
  return kNames.at(static_cast<std::size_t>(severity));
}

std::string subject_of(const std::vector<MarkerId>& markers, bool with_family) {
  constexpr std::size_t kMostIds = 30;
  std::string subject = markers.size() == 1 ? "marker" : "markers";
  for (std::size_t i = 0; i < std::min(markers.size(), kMostIds); ++i) {
    subject += (i > 0 ? ", " : " ") + format_marker_id(markers[i], with_family);
  }
  if (markers.size() > kMostIds) subject += fmt::format(", … ({} in all)", markers.size());
  return subject;
}

std::string give_or_take(double value, double sigma, const char* unit, int decimals) {
  constexpr int kMostDecimals = 6;
  if (sigma > 0) {
    const int needed = static_cast<int>(std::ceil(-std::log10(sigma)));
    decimals = std::clamp(needed, decimals, std::max(decimals, kMostDecimals));
  }
  return fmt::format("{:.{}f} ± {:.{}f}{}", value, decimals, sigma, decimals, unit);
}

std::string one_line(const Finding& finding) {
  std::string line = fmt::format("{} [{}] {}: {}", name_of(finding.severity),
                                 name_of(finding.cause), finding.subject, finding.text);
  if (!finding.remedy.empty()) line += " " + finding.remedy;
  return in_one_line(line);
}

void sort_worst_first(std::vector<Finding>& findings) {
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity < b.severity; });
}

std::vector<std::string> lines_per_cause(const std::vector<Finding>& findings) {
  std::vector<std::string> lines;
  std::set<Cause> shown;
  for (const Finding& finding : findings) {
    if (!shown.insert(finding.cause).second) continue;
    const auto alike = std::count_if(findings.begin(), findings.end(), [&](const Finding& other) {
      return other.cause == finding.cause;
    });
    lines.push_back(one_line(finding));
    if (alike > 1) {
      lines.back() += fmt::format(" (and {} more of [{}]: --report shows all)", alike - 1,
                                  name_of(finding.cause));
    }
  }
  return lines;
}

std::size_t count_of(Severity severity, const std::vector<Finding>& findings) {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(),
                    [&](const Finding& finding) { return finding.severity == severity; }));
}

}  // namespace waymark
