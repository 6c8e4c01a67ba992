#include "mapbuilder/diagnosis/frame_findings.h"

#include <fmt/format.h>

namespace waymark {

std::vector<Finding> frame_findings(const FrameComparison& comparison) {
  constexpr double kDegreesPerRadian = 57.29577951308232;
  std::vector<Finding> findings;
  for (const MovedMarker& marker : comparison.moved) {
    Finding finding;
    finding.kind = FindingKind::marker_moved;
    finding.title = "A marker stands elsewhere than in the earlier map";
    finding.evidence = fmt::format(
        "It moved by {:.1f} mm and turned by {:.2f}°; {} markers stayed where they were.",
        1e3 * marker.distance_m, kDegreesPerRadian * marker.turn_rad, comparison.unmoved);
    finding.remedy = "If nobody moved it on purpose, see whether it hangs loose.";
    finding.markers = {marker.id};
    finding.figures = {{"moved", marker.distance_m, "m", {}},
                       {"turned", kDegreesPerRadian * marker.turn_rad, "°", {}}};
    findings.push_back(finding);
  }
  const auto listed = [&](FindingKind kind, const std::vector<MarkerId>& markers, const char* title,
                          const char* evidence, const char* remedy) {
    if (markers.empty()) return;
    Finding finding;
    finding.kind = kind;
    finding.severity = Severity::note;
    finding.title = title;
    finding.evidence = evidence;
    finding.remedy = remedy;
    finding.markers = markers;
    findings.push_back(finding);
  };
  listed(FindingKind::marker_appeared, comparison.appeared, "Markers that the earlier map lacks",
         "They are mapped now and were not then.", "Nothing needs to be done.");
  listed(FindingKind::marker_vanished, comparison.vanished, "Markers of the earlier map are gone",
         "They were mapped then and are not now: taken down, covered, or not visited.",
         "If they still hang there, record a capture that sees them.");
  return findings;
}

Finding frame_not_found() {
  Finding finding;
  finding.kind = FindingKind::marker_moved;
  finding.severity = Severity::error;
  finding.title = "The earlier map's world could not be found";
  finding.evidence =
      "Fewer than 3 markers of both maps stand alike against each other; the new map has a world "
      "of "
      "its own, and stored waypoints do not hold in it.";
  finding.remedy = "See that --frame-of names a map of this building.";
  return finding;
}

}  // namespace waymark
