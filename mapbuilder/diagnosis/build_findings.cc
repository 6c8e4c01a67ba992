#include "mapbuilder/diagnosis/build_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "mapbuilder/diagnosis/observation_findings.h"

namespace waymark {
namespace {

Figure count_figure(const char* name, std::size_t count) {
  return {name, static_cast<double>(count), "", {}};
}

/// "1 marker", "3 markers".
std::string plural(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string submap_name(std::size_t index) { return fmt::format("sub-map {}", index); }

Finding submaps_found(const BuildResult& result) {
  Finding finding;
  finding.cause = Cause::disconnected;
  finding.subject = fmt::format("{} parts", result.submaps.size());
  finding.text =
      "no frame set sees markers of two of them, so each is a sub-map with a frame of its own.";
  finding.remedy = "Record a capture that sees markers of both parts to join them.";
  for (const BuiltSubMap& submap : result.submaps) {
    finding.figures.push_back(count_figure("markers", submap.map.markers.size()));
  }
  return finding;
}

Finding not_converged_found(const BuiltSubMap& submap) {
  Finding finding;
  finding.cause = Cause::map_misfit;
  finding.text = fmt::format(
      "adjustment and gate did not come to rest: after the last pass the gate still changed its "
      "mind about some of {} observations.",
      submap.observations);
  finding.remedy = "Look at the residuals before you trust this map.";
  finding.figures = {{"RMS of accepted corners", submap.map.rms_px, "px", {}}};
  return finding;
}

Finding unknown_covariances_found(const BuiltSubMap& submap) {
  Finding finding;
  finding.cause = Cause::few_views;
  finding.text = fmt::format(
      "the uncertainties of its {} are unknown, and locd will call no pose by them OK: their "
      "equations can't be solved. Either the observations leave one or more of them free, or they "
      "tie them so weakly, over so long a way, that rounding hides it.",
      plural(submap.map.markers.size(), "marker"));
  finding.remedy =
      "Record more views that see several markers at once, where the map hangs by a thread; look "
      "at "
      "the sigmas of the survey.";
  return finding;
}

Finding poor_fit_found(const BuiltSubMap& submap) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::map_misfit;
  finding.text = fmt::format("the map does not fit the images: corners are {:.0f} px off and more.",
                             kLargestModelSigma);
  finding.remedy = "Check rig.yaml, and the sizes and ids in markers.toml.";
  finding.figures = {{"RMS of accepted corners", submap.map.rms_px, "px", {}}};
  return finding;
}

Finding single_views_found(std::vector<MarkerId> markers, bool with_family) {
  Finding finding;
  finding.cause = Cause::few_views;
  finding.subject = subject_of(markers, with_family);
  finding.text =
      "one view, not verified: no second view of a rig that other markers place as well confirms "
      "where they are; a wrong id would not be noticed.";
  finding.remedy = "Record another view of each together with its neighbours.";
  finding.figures = {count_figure("markers of one view", markers.size())};
  finding.markers = std::move(markers);
  return finding;
}

Finding unmapped_found(std::vector<MarkerId> unmapped, bool with_family) {
  Finding finding;
  finding.cause = Cause::few_views;
  finding.subject = subject_of(unmapped, with_family);
  finding.text = "seen but not mapped: no pose explains their views.";
  finding.remedy =
      "Check whether they moved or hang twice in the building; else add them to `ignore` in "
      "markers.toml.";
  finding.figures = {count_figure("markers not mapped", unmapped.size())};
  finding.markers = std::move(unmapped);
  return finding;
}

/// Unmapped markers of one sight: as likely misreadings, and no reason to record again.
Finding lone_sights_found(std::vector<MarkerId> lone, bool with_family) {
  Finding finding;
  finding.severity = Severity::note;
  finding.cause = Cause::few_views;
  finding.subject = subject_of(lone, with_family);
  finding.text = "seen once and not mapped: a misreading as likely as a marker.";
  finding.remedy = "If it hangs there, record it together with its neighbours.";
  finding.figures = {count_figure("markers seen once", lone.size())};
  finding.markers = std::move(lone);
  return finding;
}

/// Takes out of `markers` those that one frame set alone has seen.
std::vector<MarkerId> take_lone_sights(const Observations& observations,
                                       std::vector<MarkerId>& markers) {
  std::map<MarkerId, std::set<FrameSetIndex>> seen;
  for (const Observation& o : observations.all) {
    seen[observations.markers[o.marker]].insert(o.frame_set);
  }
  const auto split =
      std::stable_partition(markers.begin(), markers.end(),
                            [&](const MarkerId& marker) { return seen[marker].size() != 1; });
  std::vector<MarkerId> lone(split, markers.end());
  markers.erase(split, markers.end());
  return lone;
}

Finding unlocalized_found(const BuildResult& result, const Observations& observations) {
  Finding finding;
  finding.cause = Cause::few_views;
  finding.subject = plural(result.unlocalized.size(), "frame set");
  finding.text = "not localized: they see markers, but no pose of the rig explains what they see.";
  finding.remedy = "Look at their images for blur, or for markers that are not in the map.";
  finding.figures = {count_figure("frame sets without a pose", result.unlocalized.size()),
                     count_figure("frame sets in all", observations.frame_sets.size())};
  return finding;
}

Finding blank_found(const BuildResult& result, const Observations& observations) {
  Finding finding;
  finding.severity = Severity::note;
  finding.cause = Cause::few_views;
  finding.subject = plural(result.without_markers.size(), "frame set");
  finding.text = "without a usable marker: they tell nothing about the map.";
  finding.figures = {count_figure("frame sets without markers", result.without_markers.size()),
                     count_figure("frame sets in all", observations.frame_sets.size())};
  return finding;
}

void add_submap_findings(const BuiltSubMap& submap, std::size_t index, bool with_family,
                         std::vector<Finding>& findings) {
  const auto add = [&](Finding finding) {
    finding.submap = index;
    if (finding.subject.empty()) finding.subject = submap_name(index);
    findings.push_back(std::move(finding));
  };
  if (submap.model_sigma_px >= kLargestModelSigma) add(poor_fit_found(submap));
  if (!submap.converged) add(not_converged_found(submap));
  // A single marker has none to be uncertain against.
  if (!submap.covariances_known && submap.map.markers.size() > 1)
    add(unknown_covariances_found(submap));
  std::vector<MarkerId> single;
  for (const MapMarker& marker : submap.map.markers) {
    if (!marker.verified) single.push_back(marker.id);
  }
  if (!single.empty()) add(single_views_found(std::move(single), with_family));
}

}  // namespace

std::vector<Finding> build_findings(const BuildResult& result, const Observations& observations,
                                    const std::set<MarkerId>& explained) {
  const bool with_family = observations.several_families();
  std::vector<Finding> findings;
  if (result.submaps.size() > 1) findings.push_back(submaps_found(result));
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    add_submap_findings(result.submaps[i], i, with_family, findings);
  }
  std::vector<MarkerId> unmapped = result.unmapped;
  std::erase_if(unmapped, [&](const MarkerId& marker) { return explained.contains(marker); });
  auto lone = take_lone_sights(observations, unmapped);
  if (!unmapped.empty()) findings.push_back(unmapped_found(std::move(unmapped), with_family));
  if (!lone.empty()) findings.push_back(lone_sights_found(std::move(lone), with_family));
  if (!result.unlocalized.empty()) findings.push_back(unlocalized_found(result, observations));
  for (Finding& finding : observation_findings(observations))
    findings.push_back(std::move(finding));
  if (!result.without_markers.empty()) findings.push_back(blank_found(result, observations));
  return findings;
}

}  // namespace waymark
