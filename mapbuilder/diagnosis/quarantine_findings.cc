#include "mapbuilder/diagnosis/quarantine_findings.h"

#include <fmt/format.h>

#include <algorithm>

namespace waymark {
namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

const MovedMarker* find(const std::vector<MovedMarker>& markers, const MarkerId& id) {
  const auto found = std::find_if(markers.begin(), markers.end(),
                                  [&](const MovedMarker& marker) { return marker.id == id; });
  return found == markers.end() ? nullptr : &*found;
}

bool is_mapped(const BuildResult& result, const MarkerId& id) {
  return std::any_of(result.map.submaps.begin(), result.map.submaps.end(), [&](const SubMap& map) {
    return std::any_of(map.markers.begin(), map.markers.end(),
                       [&](const MapMarker& marker) { return marker.id == id; });
  });
}

Finding confirmed(const QuarantinedMarker& quarantined, const MovedMarker& moved) {
  Finding finding;
  finding.kind = FindingKind::marker_moved;
  finding.severity = Severity::note;
  finding.title = "The vehicle was right: a marker of its quarantine has moved";
  finding.evidence = fmt::format("By {:.1f} mm; the vehicle had found {:.1f} mm.",
                                 1e3 * moved.distance_m, 1e3 * quarantined.offset_m);
  finding.remedy = "Give the vehicle this map: its quarantine ends with the old one.";
  finding.markers = {quarantined.marker};
  finding.figures = {{"moved", moved.distance_m, "m", {}},
                     {"by the vehicle", quarantined.offset_m, "m", {}}};
  return finding;
}

Finding refuted(const QuarantinedMarker& quarantined, const MovedMarker& place) {
  Finding finding;
  finding.kind = FindingKind::quarantine_refuted;
  finding.title = "A marker of the quarantine stands where it stood";
  finding.evidence = fmt::format(
      "Within {:.1f} mm and {:.2f}° of its place in the earlier map; the vehicle had found {:.1f} "
      "mm.",
      1e3 * place.distance_m, kDegreesPerRadian * place.turn_rad, 1e3 * quarantined.offset_m);
  finding.remedy =
      "See whether it hangs loose, whether another with its number hangs near, and whether the "
      "vehicle's cameras stand as its rig file says.";
  finding.markers = {quarantined.marker};
  finding.figures = {{"off", place.distance_m, "m", {}},
                     {"by the vehicle", quarantined.offset_m, "m", {}}};
  return finding;
}

void add_listed(FindingKind kind, Severity severity, std::vector<MarkerId> markers,
                const char* title, const std::string& evidence, const char* remedy,
                std::vector<Finding>& findings) {
  if (markers.empty()) return;
  Finding finding;
  finding.kind = kind;
  finding.severity = severity;
  finding.title = title;
  finding.evidence = evidence;
  finding.remedy = remedy;
  std::sort(markers.begin(), markers.end());
  finding.markers = std::move(markers);
  findings.push_back(std::move(finding));
}

}  // namespace

std::set<MarkerId> moved_markers(const Quarantine& quarantine) {
  std::set<MarkerId> markers;
  for (const QuarantinedMarker& marker : quarantine.markers) {
    if (marker.state == QuarantineState::moved) markers.insert(marker.marker);
  }
  return markers;
}

std::vector<Finding> quarantine_findings(const Quarantine& quarantine, const BuildResult& result,
                                         const FrameComparison* comparison) {
  std::vector<Finding> findings;
  std::vector<MarkerId> not_mapped;
  std::vector<MarkerId> not_compared;
  std::vector<MarkerId> known_now;
  for (const QuarantinedMarker& marker : quarantine.markers) {
    const bool moved = marker.state == QuarantineState::moved;
    const MovedMarker* elsewhere =
        comparison != nullptr ? find(comparison->moved, marker.marker) : nullptr;
    const MovedMarker* in_place =
        comparison != nullptr ? find(comparison->suspects_in_place, marker.marker) : nullptr;
    if (!is_mapped(result, marker.marker)) {
      not_mapped.push_back(marker.marker);
    } else if (!moved) {
      known_now.push_back(marker.marker);
    } else if (elsewhere != nullptr) {
      findings.push_back(confirmed(marker, *elsewhere));
    } else if (in_place != nullptr) {
      findings.push_back(refuted(marker, *in_place));
    } else {
      not_compared.push_back(marker.marker);
    }
  }
  add_listed(FindingKind::marker_appeared, Severity::note, std::move(known_now),
             "Markers that the vehicle did not know are mapped",
             "They hung there and its map lacked them.", "Nothing needs to be done.", findings);
  add_listed(FindingKind::quarantine_open, Severity::warning, std::move(not_mapped),
             "Markers of the quarantine are not mapped now",
             "No capture places them: nothing tells whether the vehicle was right.",
             "Look at them; if they still hang there, record a capture that sees them.", findings);
  add_listed(FindingKind::quarantine_open, Severity::note, std::move(not_compared),
             "Markers of the quarantine are mapped, but not compared",
             fmt::format("Their old places are in map {}, in whose world this map was not laid.",
                         quarantine.map_hash),
             "Build with --frame-of that map to see whether the vehicle was right.", findings);
  return findings;
}

}  // namespace waymark
