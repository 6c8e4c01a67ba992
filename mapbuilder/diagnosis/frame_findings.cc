#include "mapbuilder/diagnosis/frame_findings.h"

#include <fmt/format.h>

#include "core/geometry/degrees.h"

namespace waymark {

namespace {

Finding moved(const ComparedMarker& marker, std::size_t unmoved, bool with_family) {
  Finding finding;
  finding.cause = Cause::moved;
  finding.subject = subject_of({marker.id}, with_family);
  finding.text = fmt::format(
      "stands elsewhere than in the earlier map: it moved by {:.1f} mm and turned by {:.2f}°; {} "
      "markers stayed where they were.",
      1e3 * marker.distance_m, kDegreesPerRadian * marker.turn_rad, unmoved);
  finding.remedy = "If nobody moved it on purpose, see whether it hangs loose.";
  finding.markers = {marker.id};
  finding.figures = {{"moved", marker.distance_m, "m", {}},
                     {"turned", kDegreesPerRadian * marker.turn_rad, "°", {}}};
  return finding;
}

void add_listed(const std::vector<MarkerId>& markers, bool with_family, const char* text,
                const char* remedy, std::vector<Finding>& findings) {
  if (markers.empty()) return;
  Finding finding;
  finding.severity = Severity::note;
  finding.cause = Cause::moved;
  finding.subject = subject_of(markers, with_family);
  finding.text = text;
  finding.remedy = remedy;
  finding.figures = {{"markers", static_cast<double>(markers.size()), "", {}}};
  finding.markers = markers;
  findings.push_back(std::move(finding));
}

}  // namespace

std::vector<Finding> frame_findings(const FrameComparison& comparison, bool with_family) {
  std::vector<Finding> findings;
  for (const ComparedMarker& marker : comparison.moved) {
    findings.push_back(moved(marker, comparison.stayed.size(), with_family));
  }
  add_listed(comparison.appeared, with_family, "new: mapped now and not in the earlier map.", "",
             findings);
  add_listed(comparison.vanished, with_family,
             "gone: mapped in the earlier map and not now: taken down, covered, or not visited.",
             "If they still hang there, record a capture that sees them.", findings);
  return findings;
}

Finding frame_not_found(const std::filesystem::path& earlier) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::other_place;
  finding.subject = earlier.string();
  finding.text =
      "the earlier map's world could not be found: fewer than 3 markers of both maps stand alike "
      "against each other, and stored waypoints would not hold in the new map.";
  finding.remedy = "See that --frame-of names a map of this building.";
  return finding;
}

Finding not_levelled(std::size_t submap, std::size_t markers, LevelBy by) {
  Finding finding;
  finding.cause = Cause::not_level;
  finding.subject = fmt::format("sub-map {}", submap);
  finding.text = fmt::format(
      "not levelled, its axes are the mapper's choice: its {} marker{} not tell where up is.",
      markers, markers == 1 ? " does" : "s do");
  finding.remedy =
      by == LevelBy::walls
          ? "By walls it takes walls that face different ways, and cameras that stand upright."
          : "By floor it takes 2 markers that lie on the floor, and cameras that do not look "
            "straight down all the way.";
  finding.submap = submap;
  return finding;
}

}  // namespace waymark
