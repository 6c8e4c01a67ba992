#include "mapbuilder/diagnosis/quarantine_findings.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/geometry/degrees.h"

namespace waymark {
namespace {

const ComparedMarker* find(const std::vector<ComparedMarker>& markers, const MarkerId& id) {
  const auto found = std::find_if(markers.begin(), markers.end(),
                                  [&](const ComparedMarker& marker) { return marker.id == id; });
  return found == markers.end() ? nullptr : &*found;
}

bool is_mapped(const BuildResult& result, const MarkerId& id) {
  return std::any_of(result.map.submaps.begin(), result.map.submaps.end(), [&](const SubMap& map) {
    return std::any_of(map.markers.begin(), map.markers.end(),
                       [&](const MapMarker& marker) { return marker.id == id; });
  });
}

Finding about(const MarkerId& marker, bool with_family) {
  Finding finding;
  finding.cause = Cause::moved;
  finding.subject = subject_of({marker}, with_family);
  finding.markers = {marker};
  return finding;
}

Finding confirmed(const QuarantinedMarker& quarantined, const ComparedMarker& moved,
                  bool with_family) {
  Finding finding = about(quarantined.marker, with_family);
  finding.severity = Severity::note;
  finding.text = fmt::format(
      "the vehicle was right: it has moved by {:.1f} mm; the vehicle had found {:.1f} mm.",
      1e3 * moved.distance_m, 1e3 * quarantined.offset_m);
  finding.remedy = "Give the vehicle this map: its quarantine ends with the old one.";
  finding.figures = {{"moved", moved.distance_m, "m", {}},
                     {"by the vehicle", quarantined.offset_m, "m", {}}};
  return finding;
}

Finding refuted(const QuarantinedMarker& quarantined, const ComparedMarker& place,
                bool with_family) {
  Finding finding = about(quarantined.marker, with_family);
  finding.text = fmt::format(
      "in quarantine, but stands where it stood, within {:.1f} mm and {:.2f}° of its place in the "
      "earlier map; the vehicle had found {:.1f} mm.",
      1e3 * place.distance_m, kDegreesPerRadian * place.turn_rad, 1e3 * quarantined.offset_m);
  finding.remedy =
      "See whether it hangs loose, whether another with its number hangs near, and whether the "
      "vehicle's cameras stand as its rig file says.";
  finding.figures = {{"off", place.distance_m, "m", {}},
                     {"by the vehicle", quarantined.offset_m, "m", {}}};
  return finding;
}

void add_listed(Severity severity, std::vector<MarkerId> markers, bool with_family,
                const std::string& text, const char* remedy, std::vector<Finding>& findings) {
  if (markers.empty()) return;
  std::sort(markers.begin(), markers.end());
  Finding finding;
  finding.severity = severity;
  finding.cause = Cause::moved;
  finding.subject = subject_of(markers, with_family);
  finding.text = text;
  finding.remedy = remedy;
  finding.figures = {{"markers", static_cast<double>(markers.size()), "", {}}};
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
                                         const FrameComparison* comparison, bool with_family) {
  std::vector<Finding> findings;
  std::vector<MarkerId> not_mapped;
  std::vector<MarkerId> not_compared;
  std::vector<MarkerId> known_now;
  for (const QuarantinedMarker& marker : quarantine.markers) {
    if (marker.state == QuarantineState::ignored) continue;  // says nothing of where it hangs
    const bool moved = marker.state == QuarantineState::moved;
    const ComparedMarker* elsewhere =
        comparison != nullptr ? find(comparison->moved, marker.marker) : nullptr;
    const ComparedMarker* in_place =
        comparison != nullptr ? find(comparison->suspects_in_place, marker.marker) : nullptr;
    if (!is_mapped(result, marker.marker)) {
      not_mapped.push_back(marker.marker);
    } else if (!moved) {
      known_now.push_back(marker.marker);
    } else if (elsewhere != nullptr) {
      findings.push_back(confirmed(marker, *elsewhere, with_family));
    } else if (in_place != nullptr) {
      findings.push_back(refuted(marker, *in_place, with_family));
    } else {
      not_compared.push_back(marker.marker);
    }
  }
  add_listed(Severity::note, std::move(known_now), with_family,
             "unknown to the vehicle, mapped now: they hung there and its map lacked them.", "",
             findings);
  add_listed(Severity::warning, std::move(not_mapped), with_family,
             "in quarantine and not mapped now: no capture places them, and nothing tells whether "
             "the vehicle was right.",
             "Look at them; if they still hang there, record a capture that sees them.", findings);
  add_listed(Severity::note, std::move(not_compared), with_family,
             fmt::format("in quarantine and mapped, but not compared: their old places are in map "
                         "{}, in whose world this map was not laid.",
                         quarantine.map_hash),
             "Build with --frame-of that map to see whether the vehicle was right.", findings);
  return findings;
}

}  // namespace waymark
