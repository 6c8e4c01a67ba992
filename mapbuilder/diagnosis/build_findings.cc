#include "mapbuilder/diagnosis/build_findings.h"

#include <fmt/format.h>

namespace waymark {
namespace {

Figure count_of(const char* name, std::size_t count) {
  return {name, static_cast<double>(count), "", {}};
}

/// "1 marker", "3 markers".
std::string plural(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

Finding submaps_found(const BuildResult& result) {
  Finding finding;
  finding.kind = FindingKind::submaps;
  finding.title = fmt::format("The captures fall into {} parts", result.submaps.size());
  finding.evidence =
      "No frame set sees markers of two of them, so each is a sub-map with a frame of its own.";
  finding.remedy = "Record a capture that sees markers of both parts to join them.";
  for (const BuiltSubMap& submap : result.submaps) {
    finding.figures.push_back(count_of("markers", submap.map.markers.size()));
  }
  return finding;
}

Finding not_converged_found(const BuiltSubMap& submap) {
  Finding finding;
  finding.kind = FindingKind::unsettled;
  finding.title = "Adjustment and gate did not come to rest";
  finding.evidence = fmt::format(
      "After the last pass the gate still changed its mind about some of {} observations.",
      submap.observations);
  finding.remedy = "Look at the residuals before you trust this map.";
  finding.figures = {{"RMS of accepted corners", submap.map.rms_px, "px", {}}};
  return finding;
}

Finding unknown_covariances_found() {
  Finding finding;
  finding.kind = FindingKind::covariances_unknown;
  finding.title = "Uncertainties are unknown";
  finding.evidence =
      "The observations don't fix all markers against each other; the map holds no covariances, "
      "and "
      "locd will call no pose in it OK.";
  finding.remedy = "Record more views that see several markers at once.";
  return finding;
}

Finding poor_fit_found(const BuiltSubMap& submap) {
  Finding finding;
  finding.kind = FindingKind::poor_fit;
  finding.severity = Severity::error;
  finding.title = "The map does not fit the images";
  finding.evidence = fmt::format("Corners are {:.0f} px off and more.", kLargestModelSigma);
  finding.remedy = "Check rig.yaml, and the sizes and ids in markers.toml.";
  finding.figures = {{"RMS of accepted corners", submap.map.rms_px, "px", {}}};
  return finding;
}

Finding single_views_found(std::vector<MarkerId> markers) {
  Finding finding;
  finding.kind = FindingKind::one_view;
  finding.title = fmt::format("{}: one view, not verified", plural(markers.size(), "marker"));
  finding.evidence =
      "No second view of a rig that other markers place as well confirms where they are; a wrong "
      "id would not be noticed.";
  finding.remedy = "Record another view of each together with its neighbours.";
  finding.markers = std::move(markers);
  return finding;
}

Finding unmapped_found(const BuildResult& result) {
  Finding finding;
  finding.kind = FindingKind::unmapped;
  finding.title = plural(result.unmapped.size(), "marker") + " seen but not mapped";
  finding.evidence = "No pose explains their views.";
  finding.remedy =
      "Check whether they moved or hang twice in the building; else add them to `ignore` in "
      "markers.toml.";
  finding.markers = result.unmapped;
  return finding;
}

Finding unlocalized_found(const BuildResult& result, const Observations& observations) {
  Finding finding;
  finding.kind = FindingKind::unlocalized;
  finding.title = plural(result.unlocalized.size(), "frame set") + " could not be localized";
  finding.evidence = "They see markers, but no pose of the rig explains what they see.";
  finding.remedy = "Look at their images for blur, or for markers that are not in the map.";
  finding.figures = {count_of("frame sets without a pose", result.unlocalized.size()),
                     count_of("frame sets in all", observations.frame_sets.size())};
  return finding;
}

Finding repeated_found(const Observations& observations) {
  Finding finding;
  finding.kind = FindingKind::repeated_in_image;
  finding.title = plural(observations.repeated_in_image, "detection") +
                  " left out: their id was found twice in one image";
  finding.evidence = "Neither of two markers with one id can be trusted.";
  finding.remedy = "Check whether a marker is printed twice.";
  return finding;
}

Finding degenerate_found(const Observations& observations) {
  Finding finding;
  finding.kind = FindingKind::no_square;
  finding.severity = Severity::note;
  finding.title = plural(observations.degenerate, "detection") +
                  " left out: their corners are no view of a square";
  finding.evidence = "They lie outside the lens's domain, or cross.";
  return finding;
}

Finding blank_found(const BuildResult& result, const Observations& observations) {
  Finding finding;
  finding.kind = FindingKind::no_marker_seen;
  finding.severity = Severity::note;
  finding.title = plural(result.without_markers.size(), "frame set") + " without a usable marker";
  finding.evidence = "They tell nothing about the map.";
  finding.figures = {count_of("frame sets without markers", result.without_markers.size()),
                     count_of("frame sets in all", observations.frame_sets.size())};
  return finding;
}

void add_submap_findings(const BuiltSubMap& submap, std::size_t index,
                         std::vector<Finding>& findings) {
  const auto add = [&](Finding finding) {
    finding.submap = index;
    findings.push_back(std::move(finding));
  };
  if (!submap.converged) add(not_converged_found(submap));
  if (!submap.covariances_known) add(unknown_covariances_found());
  if (submap.model_sigma_px >= kLargestModelSigma) add(poor_fit_found(submap));
  std::vector<MarkerId> single;
  for (const MapMarker& marker : submap.map.markers) {
    if (!marker.verified) single.push_back(marker.id);
  }
  if (!single.empty()) add(single_views_found(std::move(single)));
}

}  // namespace

std::vector<Finding> build_findings(const BuildResult& result, const Observations& observations) {
  std::vector<Finding> findings;
  if (result.submaps.size() > 1) findings.push_back(submaps_found(result));
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    add_submap_findings(result.submaps[i], i, findings);
  }
  if (!result.unmapped.empty()) findings.push_back(unmapped_found(result));
  if (!result.unlocalized.empty()) findings.push_back(unlocalized_found(result, observations));
  if (observations.repeated_in_image > 0) findings.push_back(repeated_found(observations));
  if (observations.degenerate > 0) findings.push_back(degenerate_found(observations));
  if (!result.without_markers.empty()) findings.push_back(blank_found(result, observations));
  return findings;
}

}  // namespace waymark
