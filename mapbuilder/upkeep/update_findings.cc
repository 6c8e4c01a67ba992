#include "mapbuilder/upkeep/update_findings.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/geometry/degrees.h"
#include "mapbuilder/diagnosis/frame_findings.h"

namespace waymark {
namespace {

Finding listed(Severity severity, Cause cause, std::vector<MarkerId> markers, bool with_family,
               const char* text, const char* remedy) {
  Finding finding;
  finding.severity = severity;
  finding.cause = cause;
  finding.subject = subject_of(markers, with_family);
  finding.text = text;
  finding.remedy = remedy;
  finding.figures = {{"markers", static_cast<double>(markers.size()), "", {}}};
  finding.markers = std::move(markers);
  return finding;
}

Finding about(const ComparedMarker& marker, Severity severity, Cause cause, bool with_family) {
  Finding finding;
  finding.severity = severity;
  finding.cause = cause;
  finding.subject = subject_of({marker.id}, with_family);
  finding.markers = {marker.id};
  finding.figures = {{"off", marker.distance_m, "m", marker.sigma_m},
                     {"turned", kDegreesPerRadian * marker.turn_rad, "°", {}}};
  return finding;
}

Finding doubted(const ComparedMarker& marker, bool with_family) {
  Finding finding = about(marker, Severity::warning, Cause::few_views, with_family);
  finding.text = fmt::format(
      "seen {:.1f} mm and {:.2f}° from where it stood, but by one view alone, or tilted as if it "
      "were seen flipped, less surely than the map has it; it is left there.",
      1e3 * marker.distance_m, kDegreesPerRadian * marker.turn_rad);
  finding.remedy = "Record more views of it, from different places, and update again.";
  return finding;
}

Finding shifted(const ComparedMarker& marker, bool with_family) {
  Finding finding = about(marker, Severity::note, Cause::moved, with_family);
  finding.text = fmt::format(
      "off by {:.2f} mm, {:.1f} sigmas: less than what counts as moved, more than "
      "chance; it is where the round sees it.",
      1e3 * marker.distance_m, marker.distance_m / marker.sigma_m.value_or(1.0));
  return finding;
}

Finding missing(const MissingMarker& marker, bool dropped, bool with_family) {
  Finding finding;
  finding.cause = Cause::moved;
  finding.subject = subject_of({marker.id}, with_family);
  finding.markers = {marker.id};
  finding.text = fmt::format(
      "not seen where it should be: {} frame sets look at its place with clear sight and none "
      "finds "
      "it; {}.",
      marker.empty_looks, dropped ? "it has left the map" : "it is kept, as not verified");
  finding.remedy = dropped
                       ? "If it still hangs there, clean it and record it again."
                       : "If it was taken down, --drop-unseen or edit --remove takes it out; if "
                         "it hangs there, edit --accept.";
  finding.figures = {{"looks", static_cast<double>(marker.empty_looks), "", {}}};
  return finding;
}

Finding misfit(const UpdatedPart& part) {
  Finding finding;
  finding.severity = Severity::note;
  finding.cause = Cause::map_misfit;
  finding.subject = fmt::format("sub-map {}", part.old_submap);
  finding.text = fmt::format(
      "round and map differ by {:.1f} times what their sigmas say: these hold noise, and "
      "calibrations differ; the sigmas of what was seen again are so much larger.",
      part.misfit_sigmas);
  finding.remedy = "Calibrate the cameras anew, or build with --refine.";
  finding.figures = {{"misfit", part.misfit_sigmas, "σ", {}}};
  finding.submap = part.old_submap;
  return finding;
}

/// What of a comparison is new or was placed anew.
FrameComparison taken(const MapUpdate& update, const UpdatedPart& part) {
  FrameComparison comparison = part.comparison;
  std::erase_if(comparison.moved, [&](const ComparedMarker& marker) {
    return std::any_of(update.doubted.begin(), update.doubted.end(),
                       [&](const ComparedMarker& one) { return one.id == marker.id; });
  });
  std::erase_if(comparison.appeared, [&](const MarkerId& id) {
    return !std::binary_search(update.appeared.begin(), update.appeared.end(), id);
  });
  comparison.vanished.clear();
  return comparison;
}

void append(std::vector<Finding> more, std::vector<Finding>& findings) {
  for (Finding& finding : more) findings.push_back(std::move(finding));
}

void add_listed(const MapUpdate& update, bool with_family, std::vector<Finding>& findings) {
  if (!update.other_part.empty()) {
    findings.push_back(listed(Severity::warning, Cause::moved, update.other_part, with_family,
                              "carried over from one part of the map to another.", ""));
  }
  if (!update.not_taken.empty()) {
    findings.push_back(listed(
        Severity::warning, Cause::disconnected, update.not_taken, with_family,
        "seen, but nothing ties what was seen of them to the map; they are left as they were.",
        "Record a capture that sees them together with markers of the map."));
  }
  if (!update.joined_parts.empty()) {
    Finding finding;
    finding.severity = Severity::note;
    finding.cause = Cause::disconnected;
    finding.subject = "map";
    finding.text =
        "the round sees several of its parts together; an update leaves them apart, each in its "
        "own world.";
    finding.remedy = "To join them, build from all captures, with --frame-of this map.";
    findings.push_back(std::move(finding));
  }
}

}  // namespace

std::vector<Finding> update_findings(const MapUpdate& update, const UpdateOptions& options,
                                     bool with_family) {
  std::vector<Finding> findings;
  for (const UpdatedPart& part : update.parts) {
    append(frame_findings(taken(update, part), with_family), findings);
    if (part.misfit_sigmas > kPoorSigmas) findings.push_back(misfit(part));
  }
  for (const ComparedMarker& marker : update.doubted) {
    findings.push_back(doubted(marker, with_family));
  }
  for (const MissingMarker& marker : update.missing) {
    findings.push_back(missing(marker, options.drop_unseen, with_family));
  }
  for (const ComparedMarker& marker : update.shifted) {
    findings.push_back(shifted(marker, with_family));
  }
  add_listed(update, with_family, findings);
  return findings;
}

FrameComparison whole_comparison(const MapUpdate& update) {
  FrameComparison whole;
  for (const UpdatedPart& part : update.parts) {
    const FrameComparison comparison = taken(update, part);
    whole.moved.insert(whole.moved.end(), comparison.moved.begin(), comparison.moved.end());
    whole.suspects_in_place.insert(whole.suspects_in_place.end(),
                                   comparison.suspects_in_place.begin(),
                                   comparison.suspects_in_place.end());
  }
  return whole;
}

}  // namespace waymark
