#include "mapbuilder/diagnosis/finding.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace waymark {
namespace {

constexpr std::array<std::string_view, 27> kKinds{"wrong_id",
                                                  "twin",
                                                  "moved_between_captures",
                                                  "moved_during_capture",
                                                  "wrong_size",
                                                  "rig_misfit",
                                                  "intrinsics_misfit",
                                                  "survey_disagrees",
                                                  "survey_undetermined",
                                                  "scale_bound",
                                                  "refinement_refused",
                                                  "one_view",
                                                  "unmapped",
                                                  "unlocalized",
                                                  "submaps",
                                                  "unsettled",
                                                  "covariances_unknown",
                                                  "repeated_in_image",
                                                  "marker_moved",
                                                  "marker_appeared",
                                                  "marker_vanished",
                                                  "poor_fit",
                                                  "no_marker_seen",
                                                  "no_square",
                                                  "quarantine_refuted",
                                                  "quarantine_open",
                                                  "rigs_differ"};
static_assert(kKinds[static_cast<std::size_t>(FindingKind::rigs_differ)] == "rigs_differ");

constexpr std::array<std::string_view, 3> kSeverities{"error", "warning", "note"};

}  // namespace

std::string_view name_of(FindingKind kind) { return kKinds.at(static_cast<std::size_t>(kind)); }

std::string_view name_of(Severity severity) {
  return kSeverities.at(static_cast<std::size_t>(severity));
}

std::string one_line(const Finding& finding, bool with_family) {
  constexpr std::size_t kMostIds = 30;
  std::string line =
      fmt::format("{}: {}: {}", name_of(finding.severity), finding.title, finding.evidence);
  if (!finding.remedy.empty()) line += " " + finding.remedy;
  if (finding.markers.empty()) return line;
  line += " Markers:";
  for (std::size_t i = 0; i < std::min(finding.markers.size(), kMostIds); ++i) {
    line += (i > 0 ? ", " : " ") + format_marker_id(finding.markers[i], with_family);
  }
  if (finding.markers.size() > kMostIds) {
    line += fmt::format(", … ({} in all)", finding.markers.size());
  }
  return line;
}

}  // namespace waymark
