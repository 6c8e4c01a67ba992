#include "mapbuilder/commands/localize_command.h"

#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/map/map_file.h"
#include "core/map/quarantine.h"
#include "mapbuilder/build/trajectory_file.h"
#include "mapbuilder/commands/output_check.h"
#include "mapbuilder/diagnosis/observation_findings.h"
#include "mapbuilder/growth/relocalization.h"

namespace waymark {
namespace {

/// Takes the markers that a vehicle found moved out of the map.
void leave_out(const Quarantine& quarantine, MarkerMap& map, std::ostream& notes) {
  std::vector<std::string> left_out;
  const bool with_family = map.several_families();
  for (SubMap& submap : map.submaps) {
    std::erase_if(submap.markers, [&](const MapMarker& marker) {
      const bool moved = std::any_of(quarantine.markers.begin(), quarantine.markers.end(),
                                     [&](const QuarantinedMarker& quarantined) {
                                       return quarantined.marker == marker.id &&
                                              quarantined.state == QuarantineState::moved;
                                     });
      if (moved) left_out.push_back(format_marker_id(marker.id, with_family));
      return moved;
    });
  }
  fmt::print(notes, "note: {} markers left out, the vehicle found them moved{}{}\n",
             left_out.size(), left_out.empty() ? "" : ": ", fmt::join(left_out, ", "));
}

}  // namespace

Status run_localize(const LocalizeOptions& options, Progress& progress, std::ostream& out,
                    std::ostream& notes) {
  if (auto writable = check_writable(options.trajectory); !writable) return writable;
  if (auto spares = check_spares(options.trajectory, {options.map}); !spares) return spares;
  if (auto fine = check(options.build); !fine) return fine;
  auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  if (options.quarantine) {
    const auto quarantine = read_quarantine_of(*options.quarantine, *map, options.map);
    if (!quarantine) return tl::make_unexpected(quarantine.error());
    leave_out(*quarantine, *map, notes);
  }
  auto taken = take_captures_in(options.input, progress, notes);
  if (!taken) return tl::make_unexpected(taken.error());
  const auto made =
      make_observations(taken->captures, {options.mono, options.input.detect.threads});
  if (!made) return tl::make_unexpected(made.error());
  std::vector<Finding> findings = std::move(taken->findings);
  for (Finding& finding : observation_findings(*made)) findings.push_back(std::move(finding));
  findings = judged(std::move(findings), options.rules);
  print_findings(findings, notes);
  if (!may_stand(findings, options.rules)) {
    return tl::make_unexpected(
        refusal_of(options.trajectory.string(), findings, "nothing was written"));
  }

  BuildOptions build = options.build;
  build.threads = options.input.detect.threads;
  const auto results = relocalize(*made, *map, build, progress);
  std::size_t observations = 0;
  for (const RelocalizedSubMap& result : results) observations += result.observations;
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
