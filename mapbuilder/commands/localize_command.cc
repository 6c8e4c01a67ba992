#include "mapbuilder/commands/localize_command.h"

#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/base/output_check.h"
#include "core/map/map_file.h"
#include "core/map/quarantine.h"
#include "mapbuilder/build/trajectory_file.h"
#include "mapbuilder/diagnosis/baseline_units.h"
#include "mapbuilder/diagnosis/clock_findings.h"
#include "mapbuilder/diagnosis/explained_build.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/diagnosis/map_causes.h"
#include "mapbuilder/diagnosis/observation_findings.h"
#include "mapbuilder/growth/relocalization.h"

namespace waymark {
namespace {

/// Takes the markers that the vehicle did not use out of the map.
void leave_out(const Quarantine& quarantine, MarkerMap& map, std::ostream& notes) {
  std::vector<std::string> left_out;
  const bool with_family = map.several_families();
  for (SubMap& submap : map.submaps) {
    std::erase_if(submap.markers, [&](const MapMarker& marker) {
      const bool unused = std::any_of(quarantine.markers.begin(), quarantine.markers.end(),
                                      [&](const QuarantinedMarker& quarantined) {
                                        return quarantined.marker == marker.id &&
                                               quarantined.state != QuarantineState::unknown;
                                      });
      if (unused) left_out.push_back(format_marker_id(marker.id, with_family));
      return unused;
    });
  }
  fmt::print(notes, "note: {} markers left out, the vehicle found them moved or ignores them{}{}\n",
             left_out.size(), left_out.empty() ? "" : ": ", fmt::join(left_out, ", "));
}

void append(std::vector<Finding> more, std::vector<Finding>& findings) {
  for (Finding& finding : more) findings.push_back(std::move(finding));
}

/// Whether map and capture contradict each other by more than a marker misread here and there.
bool is_contradicted(const RelocalizedSubMap& result) {
  constexpr std::size_t kFew = 2;
  constexpr std::size_t kOneIn = 200;
  return result.model_sigma_px > kPoorFit_px ||
         result.rejected > kFew + result.observations / kOneIn ||
         10 * result.localized < 9 * result.candidates;
}

/// Nothing else explains why corners are far off, or most observations rejected.
Finding unexplained_misfit(const RelocalizedSubMap& result) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::map_misfit;
  finding.subject = "map";
  finding.text = fmt::format(
      "the capture does not fit it: of {} observations {} are rejected, and corners are {:.1f} px "
      "off.",
      result.observations, result.rejected, result.rms_all_px);
  finding.remedy = "Check rig.yaml, sizes and ids, and whether it is the right map.";
  finding.figures = {{"RMS of all corners", result.rms_all_px, "px", {}}};
  return finding;
}

bool is_poor(const RelocalizedSubMap& result) {
  return result.model_sigma_px >= kLargestModelSigma || 2 * result.rejected > result.observations;
}

/// Why capture and map do not fit: what a build of the capture alone finds wrong with it, and what
/// the map that it gives says of the other one.
Expected<std::vector<Finding>> causes_of_misfit(const std::vector<DetectedCapture>& captures,
                                                const Observations& observations,
                                                const ObservationOptions& observing,
                                                const MarkerMap& map, const BuildOptions& options,
                                                Progress& progress) {
  auto own = build_explained(captures, observations, observing, options, progress);
  if (!own) return tl::make_unexpected(own.error());
  std::vector<Finding> findings = std::move(own->causes);
  append(map_findings(map, own->diagnosed.result, own->observations), findings);
  // Where something is wrong that all share, no marker is named.
  if (count_of(Severity::error, findings) == 0)
    append(std::move(own->diagnosed.findings), findings);
  return findings;
}

}  // namespace

Status run_localize(const LocalizeOptions& options, Progress& progress, std::ostream& out,
                    std::ostream& notes) {
  if (auto writable = check_writable(options.trajectory); !writable) return writable;
  if (auto spares =
          check_spares_input(options.trajectory, options.input, {options.map, options.quarantine});
      !spares) {
    return spares;
  }
  if (auto fine = options.build.check(); !fine) return fine;
  auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  if (options.quarantine) {
    const auto quarantine = read_quarantine_of(*options.quarantine, *map, options.map);
    if (!quarantine) return tl::make_unexpected(quarantine.error());
    leave_out(*quarantine, *map, notes);
  }
  auto taken = take_captures_in(options.input, progress, notes);
  if (!taken) return tl::make_unexpected(taken.error());
  const ObservationOptions observing{options.mono, options.input.detect.threads};
  const auto made = make_observations(taken->captures, observing);
  if (!made) return tl::make_unexpected(made.error());
  std::vector<Finding> findings = std::move(taken->findings);
  append(baseline_findings(*made), findings);
  if (!options.mono) append(clock_findings(taken->captures), findings);
  append(observation_findings(*made), findings);
  const auto tell = [&]() -> Status {
    findings = judged(std::move(findings), options.rules);
    print_findings(findings, notes);
    if (may_stand(findings, options.rules)) return {};
    return tl::make_unexpected(
        refusal_of(options.trajectory.string(), findings, "nothing was written"));
  };
  if (count_of(Severity::error, judged(findings, options.rules)) > 0) {
    if (auto stands = tell(); !stands) return stands;
    findings.clear();
  }
  if (auto any = check_any_seen(*made, options.input.paths.front()); !any) {
    print_findings(judged(std::move(findings), options.rules), notes);
    return any;
  }

  BuildOptions build = options.build;
  build.threads = options.input.detect.threads;
  const auto results = relocalize(*made, *map, build, progress);
  std::size_t observations = 0;
  for (const RelocalizedSubMap& result : results) observations += result.observations;
  if (std::any_of(results.begin(), results.end(), is_contradicted)) {
    auto causes = causes_of_misfit(taken->captures, *made, observing, *map, build, progress);
    if (!causes) return tl::make_unexpected(causes.error());
    append(*std::move(causes), findings);
  }
  if (count_of(Severity::error, findings) == 0) {
    for (const RelocalizedSubMap& result : results) {
      if (is_poor(result)) findings.push_back(unexplained_misfit(result));
    }
  }
  if (auto stands = tell(); !stands) return stands;
  if (observations == 0) {
    return fail(ErrorKind::bad_data,
                "{}: none of its {} observations is of a marker in {}; is it the right map?",
                options.input.paths.front().string(), made->usable, options.map.string());
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    const RelocalizedSubMap& result = results[i];
    if (auto written = write_trajectory(options.trajectory, i, *made, result.trajectory);
        !written) {
      return written;
    }
    fmt::print(out,
               "sub-map {}: {} frame sets localized, {} ambiguous; {} of {} with two markers or "
               "more; {} observations, {} rejected; RMS {:.4f} px over accepted, {:.4f} px over "
               "all; corner sigma {:.3f} px\n",
               i, result.trajectory.size(), result.ambiguous.size(), result.localized,
               result.candidates, result.observations, result.rejected, result.rms_px,
               result.rms_all_px, result.model_sigma_px);
  }
  return {};
}

}  // namespace waymark
