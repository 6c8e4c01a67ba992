#include "mapbuilder/commands/update_command.h"

#include <fmt/ostream.h>

#include <algorithm>
#include <chrono>

#include "core/base/output_check.h"
#include "core/map/map_check.h"
#include "core/map/map_file.h"
#include "core/map/marker_search.h"
#include "core/map/quarantine.h"
#include "mapbuilder/build/output_paths.h"
#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/commands/captures_in.h"
#include "mapbuilder/commands/print_line.h"
#include "mapbuilder/diagnosis/baseline_units.h"
#include "mapbuilder/diagnosis/calibration_findings.h"
#include "mapbuilder/diagnosis/clock_findings.h"
#include "mapbuilder/diagnosis/explained_build.h"
#include "mapbuilder/diagnosis/map_causes.h"
#include "mapbuilder/diagnosis/quarantine_findings.h"
#include "mapbuilder/report/report_folder.h"
#include "mapbuilder/report/report_of_build.h"
#include "mapbuilder/upkeep/known_sizes.h"
#include "mapbuilder/upkeep/map_info.h"
#include "mapbuilder/upkeep/update_findings.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

void append(std::vector<Finding> more, std::vector<Finding>& findings) {
  for (Finding& finding : more) findings.push_back(std::move(finding));
}

Status check_outputs(const UpdateCommandOptions& options) {
  if (auto writable = check_writable(options.output); !writable) return writable;
  if (auto spares = check_spares_input(options.output, options.input, {options.quarantine});
      !spares) {
    return spares;
  }
  for (const fs::path& beside : paths_beside_map(options.output)) {
    auto spares = check_spares_input(beside, options.input, {options.old_map, options.quarantine});
    if (!spares) return spares;
    if (auto writable = check_writable(beside); !writable) return writable;
  }
  if (options.report) return check_report_folder(*options.report);
  return {};
}

/// The old map, and what a vehicle that used it found.
struct Known {
  MarkerMap map;
  std::optional<Quarantine> quarantine;
  std::optional<std::vector<MarkerSystem>> systems;  ///< MAP.info

  [[nodiscard]] UpdateOptions options(bool drop_unseen) const {
    return {quarantine ? moved_markers(*quarantine) : std::set<MarkerId>{}, drop_unseen,
            systems.value_or(std::vector<MarkerSystem>{})};
  }

  /// Whether something is known of all markers together.
  [[nodiscard]] bool depend_on_each_other() const {
    return systems && std::all_of(systems->begin(), systems->end(),
                                  [](const MarkerSystem& one) { return one.markers() > 0; });
  }
};

Expected<Known> read_known(const UpdateCommandOptions& options) {
  auto map = read_map_file(options.old_map);
  if (!map) return tl::make_unexpected(map.error());
  Known known{*std::move(map), {}, {}};
  auto systems = read_map_info(options.old_map, known.map);
  if (!systems) return tl::make_unexpected(systems.error());
  known.systems = *std::move(systems);
  if (options.quarantine) {
    auto read = read_quarantine_of(*options.quarantine, known.map, options.old_map);
    if (!read) return tl::make_unexpected(read.error());
    known.quarantine = *std::move(read);
  }
  return known;
}

/// The captures with the sizes that the old map was built with; gives the catalogs as stated.
std::vector<MarkerCatalog> take_known_sizes(const MarkerMap& old_map,
                                            std::vector<DetectedCapture>& captures) {
  std::vector<MarkerCatalog> stated;
  for (DetectedCapture& capture : captures) {
    stated.push_back(capture.catalog);
    capture.catalog = with_sizes_of(old_map, capture.catalog);
  }
  return stated;
}

/// New markers were built with known sizes; what was stated of them is in the catalogs.
void state_sizes(const std::vector<MarkerCatalog>& catalogs, MapUpdate& update) {
  for (SubMap& submap : update.map.submaps) {
    for (MapMarker& marker : submap.markers) {
      if (!std::binary_search(update.appeared.begin(), update.appeared.end(), marker.id)) continue;
      for (const MarkerCatalog& catalog : catalogs) {
        if (const auto size_m = catalog.size_m(marker.id)) marker.stated_size_m = *size_m;
      }
    }
  }
}

/// Whatever contradicts old map and round as a whole: another place, unit, axes, scale.
std::vector<Finding> why_not(const MarkerMap& old_map, const BuildResult& round,
                             const Observations& observations) {
  std::vector<Finding> findings = map_findings(old_map, round, observations);
  std::erase_if(findings,
                [](const Finding& finding) { return finding.severity != Severity::error; });
  return findings;
}

/// Whether rig files and lenses fit. The round's own scale does not matter: the old map's holds.
std::vector<Finding> rig_findings(const BuildResult& round, const Observations& observations,
                                  const BuildOptions& build) {
  std::vector<Finding> findings = calibration_findings(round, observations, build);
  std::erase_if(findings,
                [](const Finding& finding) { return finding.cause == Cause::scale_unknown; });
  return findings;
}

/// Lays what was built of the round into the old map's worlds, for the report.
void lay_into_old_worlds(const MapUpdate& update, BuildResult& round) {
  for (const UpdatedPart& part : update.parts) {
    move_world(round.submaps[part.round_submap], part.comparison.old_from_new);
  }
}

/// The updated map with the round's tracks and residuals.
Report report_of_update(const MapUpdate& update, const BuildResult& round,
                        const Observations& observations) {
  Report report = report_of_build(round, observations, {});
  std::vector<ReportSubMap> of_round = std::move(report.submaps);
  report.map = update.map;
  report.submaps.assign(update.map.submaps.size(), {});
  for (std::size_t s = 0; s < update.map.submaps.size(); ++s) {
    ReportSubMap& told = report.submaps[s];
    for (std::size_t r = 0; r < of_round.size(); ++r) {
      const auto& markers = round.submaps[r].map.markers;
      const auto seen_here =
          std::count_if(markers.begin(), markers.end(), [&](const MapMarker& marker) {
            return find_marker(update.map.submaps[s], marker.id) != nullptr;
          });
      if (2 * seen_here <= static_cast<std::ptrdiff_t>(markers.size())) continue;
      for (ReportTrack& track : of_round[r].tracks) told.tracks.push_back(std::move(track));
      told.observations += of_round[r].observations;
      told.rejected += of_round[r].rejected;
      told.ambiguous += of_round[r].ambiguous;
      told.corner_sigma_px = std::max(told.corner_sigma_px, of_round[r].corner_sigma_px);
      told.camera_up_in_world = of_round[r].camera_up_in_world;
    }
    const auto& markers = update.map.submaps[s].markers;
    told.covariances_known = std::any_of(markers.begin(), markers.end(),
                                         [](const MapMarker& m) { return m.covariance_known(); });
  }
  return report;
}

void print_update(const MapUpdate& update, std::ostream& out) {
  fmt::print(out,
             "{} markers seen again where they stood, {} moved, {} new, {} not where they should "
             "be, {} as they were\n",
             update.improved.size() + update.shifted.size(),
             update.moved.size() + update.other_part.size(), update.appeared.size(),
             update.missing.size(), update.unseen.size() + update.doubted.size());
  for (const UpdatedPart& part : update.parts) {
    fmt::print(out,
               "sub-map {}: laid on {} markers that stayed; round and map differ by {:.2f} of what "
               "their sigmas say at most\n",
               part.old_submap, part.comparison.stayed.size(), part.misfit_sigmas);
  }
}

Expected<ReportFolder> write_report(const UpdateCommandOptions& options, const MapUpdate& update,
                                    const BuildResult& round, const Observations& observations,
                                    const std::vector<Finding>& findings) {
  Report report = report_of_update(update, round, observations);
  report.findings = findings;
  report.map_name = options.output.filename().string();
  return ReportFolder::write(*options.report, report);
}

}  // namespace

Status run_update(const UpdateCommandOptions& options, Progress& progress, std::ostream& out,
                  std::ostream& notes) {
  if (auto allowed = check_outputs(options); !allowed) return allowed;
  if (auto fine = options.build.check(); !fine) return fine;
  const auto known = read_known(options);
  if (!known) return tl::make_unexpected(known.error());
  auto taken = take_captures_in(options.input, progress, notes);
  if (!taken) return tl::make_unexpected(taken.error());
  const auto stated = take_known_sizes(known->map, taken->captures);
  const ObservationOptions observing{false, options.input.detect.threads};
  auto made = make_observations(taken->captures, observing);
  if (!made) return tl::make_unexpected(made.error());
  std::vector<Finding> findings = std::move(taken->findings);
  append(baseline_findings(*made), findings);
  append(clock_findings(taken->captures), findings);
  findings = judged(std::move(findings), options.rules);
  const std::string result_name = options.output.string();
  if (!may_stand(findings, options.rules)) {
    print_findings(findings, notes);
    return tl::make_unexpected(
        refusal_of(result_name, findings, "nothing was built of such input"));
  }
  if (auto any = check_any_seen(*made, options.input.paths.front()); !any) {
    print_findings(findings, notes);
    return any;
  }

  BuildOptions build = options.build;
  build.threads = options.input.detect.threads;
  const auto started = std::chrono::steady_clock::now();
  auto explained = build_explained(taken->captures, *std::move(made), observing, build, progress);
  if (!explained) return tl::make_unexpected(explained.error());
  const Observations& observations = explained->observations;
  BuildResult& round = explained->diagnosed.result;
  append(explained->causes, findings);
  append(not_explained(rig_findings(round, observations, build), explained->causes), findings);
  append(std::move(explained->diagnosed.findings), findings);

  RoundParts parts(observations, round, build);
  const UpdateOptions update_options = known->options(options.drop_unseen);
  auto update = update_map(known->map, options.old_map.string(), parts, update_options);
  if (!update) {
    append(why_not(known->map, round, observations), findings);
    print_findings(judged(std::move(findings), options.rules), notes);
    return tl::make_unexpected(update.error());
  }
  state_sizes(stated, *update);
  const bool with_family = update->map.several_families();
  append(update_findings(*update, update_options, with_family), findings);
  if (known->quarantine) {
    const FrameComparison whole = whole_comparison(*update);
    append(quarantine_findings(*known->quarantine, round, &whole, with_family), findings);
  }
  findings = judged(std::move(findings), options.rules);
  print_findings(findings, notes);
  if (!known->depend_on_each_other()) {
    print_line(notes,
               "note: {}: no {} of it: markers of which it does not say how they depend on each "
               "other were taken as independent, by the covariances of each",
               options.old_map.string(), info_path(options.old_map).filename().string());
  }
  if (const Status sound = check_map(update->map); !sound) {
    return fail(ErrorKind::bad_data, "{}: what came of it can't be a map: {}; nothing written",
                result_name, sound.error().message);
  }

  std::optional<ReportFolder> report;
  if (options.report) {
    lay_into_old_worlds(*update, round);
    auto written = write_report(options, *update, round, observations, findings);
    if (!written) return tl::make_unexpected(written.error());
    report.emplace(std::move(*written));
  }
  const bool stands = may_stand(findings, options.rules);
  const fs::path place = stands ? options.output : rejected_path(options.output);
  if (auto written = write_map_file(place, update->map); !written) return written;
  if (auto written = write_map_info(place, update->map, update->systems); !written) return written;
  if (report) {
    if (auto placed = report->put_in_place(); !placed) return placed;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started;
  print_update(*update, out);
  print_line(out, "{}: map {}, updated in {:.2f} s", place.string(), content_hash(update->map),
             elapsed.count());
  if (stands) return {};
  return tl::make_unexpected(
      refusal_of(result_name, findings, fmt::format("the map went to {}", place.string())));
}

}  // namespace waymark
