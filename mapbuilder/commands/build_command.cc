#include "mapbuilder/commands/build_command.h"

#include <fmt/ostream.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "core/base/output_check.h"
#include "core/map/map_check.h"
#include "core/map/map_file.h"
#include "core/map/quarantine.h"
#include "mapbuilder/build/frame_comparison.h"
#include "mapbuilder/build/output_paths.h"
#include "mapbuilder/build/trajectory_file.h"
#include "mapbuilder/commands/build_summary.h"
#include "mapbuilder/commands/improved_rig.h"
#include "mapbuilder/commands/print_line.h"
#include "mapbuilder/diagnosis/baseline_units.h"
#include "mapbuilder/diagnosis/build_findings.h"
#include "mapbuilder/diagnosis/calibration_findings.h"
#include "mapbuilder/diagnosis/clock_findings.h"
#include "mapbuilder/diagnosis/explained_build.h"
#include "mapbuilder/diagnosis/frame_findings.h"
#include "mapbuilder/diagnosis/quarantine_findings.h"
#include "mapbuilder/report/report_folder.h"
#include "mapbuilder/report/report_of_build.h"
#include "mapbuilder/upkeep/map_info.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// The survey as the report shows it, against the first sub-map.
std::vector<ReportSurveyEntry> survey_of(const BuildResult& result) {
  std::vector<ReportSurveyEntry> entries;
  for (const SurveyResidual& residual : result.submaps.front().survey) {
    ReportSurveyEntry entry;
    entry.entry = residual.entry;
    entry.markers = residual.markers;
    entry.is_point = residual.point;
    entry.check = residual.use != SurveyUse::fit;
    entry.sigma_m = residual.sigma_m;
    if (!residual.point) entry.measured_m = residual.measured_m;
    if (residual.mapped) {
      entry.residual_m = residual.residual_m;
      if (!residual.point) entry.mapped_m = residual.measured_m + residual.residual_m;
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

/// The family that a bare number in a survey means: the only one that markers.toml states, be it
/// seen or not; nullopt where several meet.
std::optional<Family> only_stated_family(const std::vector<DetectedCapture>& captures) {
  MeetingFamilies families;
  for (const DetectedCapture& capture : captures) {
    for (const auto& entry : capture.catalog.entries()) families.add(entry.family);
  }
  return families.only();
}

/// Says before the long work what could not be written after it. The map alone may take the place
/// of the earlier one (--frame-of hall.map -o hall.map).
Status check_outputs(const BuildCommandOptions& options) {
  std::vector<fs::path> outputs{options.output};
  if (options.trajectory) outputs.push_back(*options.trajectory);
  const auto refined_rig = asked_rig_path(options);
  if (refined_rig) outputs.push_back(*refined_rig);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (auto writable = check_writable(outputs[i]); !writable) return writable;
    const char* remedy = refined_rig && outputs[i] == *refined_rig
                             ? "name another file for the refined rig with --refined-rig"
                             : "name another file";
    auto spares = check_spares_input(
        outputs[i], options.input,
        {options.survey, options.quarantine, i == 0 ? std::nullopt : options.frame_of}, remedy);
    if (!spares) return spares;
  }
  for (const fs::path& beside : paths_beside_map(options.output)) {
    auto spares = check_spares_input(beside, options.input,
                                     {options.survey, options.quarantine, options.frame_of});
    if (!spares) return spares;
    if (auto writable = check_writable(beside); !writable) return writable;
    outputs.push_back(beside);
  }
  if (auto differ = check_differ(outputs, "map, trajectory and refined rig (--refined-rig)");
      !differ) {
    return differ;
  }
  if (options.report) return check_report_folder(*options.report);
  return {};
}

/// What is known to be true of the captures: folders groundtruth, where they are there. One that
/// can't be read is no reason to build no map.
std::vector<CaptureTruth> read_truths(const std::vector<DetectedCapture>& captures,
                                      std::ostream& notes) {
  std::vector<CaptureTruth> truths;
  for (const DetectedCapture& capture : captures) {
    const auto folder = fs::path(capture.name) / "groundtruth";
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) continue;
    auto truth = read_ground_truth(folder, capture.catalog.only_family());
    if (!truth) {
      fmt::print(notes, "note: {}; the report shows no truth\n", truth.error().message);
    } else if (truth->world_from_rig) {
      truths.push_back({capture.name, capture.rig, *std::move(truth->world_from_rig)});
    }
  }
  return truths;
}

/// What a build takes into account beside its captures.
struct References {
  std::optional<MarkerMap> earlier;
  std::optional<Quarantine> quarantine;
  Survey survey;
};

Expected<References> read_references(const BuildCommandOptions& options,
                                     std::optional<Family> default_family) {
  References references;
  if (options.frame_of) {
    auto map = read_map_file(*options.frame_of);
    if (!map) return tl::make_unexpected(map.error());
    references.earlier = *std::move(map);
  }
  if (options.quarantine) {
    auto read = references.earlier ? read_quarantine_of(*options.quarantine, *references.earlier,
                                                        *options.frame_of)
                                   : read_quarantine(*options.quarantine);
    if (!read) return tl::make_unexpected(read.error());
    references.quarantine = *std::move(read);
  }
  if (options.survey) {
    auto survey = read_survey(*options.survey, default_family);
    if (!survey) return tl::make_unexpected(survey.error());
    references.survey = *std::move(survey);
  }
  const auto fixes_a_frame = [](const SurveyedPoint& point) { return point.use == SurveyUse::fit; };
  if (options.frame_of && std::any_of(references.survey.points.begin(),
                                      references.survey.points.end(), fixes_a_frame)) {
    return fail(ErrorKind::usage,
                "{}: its points and --frame-of {} each name a world; leave one out, or give the "
                "points use = \"check\"",
                options.survey->string(), options.frame_of->string());
  }
  return references;
}

/// Lays the result into the world of an earlier map, its first sub-map into the first that fits,
/// by markers that are not in quarantine; nullopt when none fits. The scale stays the build's own.
std::optional<FrameComparison> take_frame_of(const MarkerMap& earlier,
                                             const std::optional<Quarantine>& quarantine,
                                             BuildResult& result) {
  const std::set<MarkerId> suspects =
      quarantine ? moved_markers(*quarantine) : std::set<MarkerId>{};
  BuiltSubMap& first = result.submaps.front();
  for (const SubMap& old : earlier.submaps) {
    const auto comparison = compare_frames(first.map, old, suspects);
    if (!comparison) continue;
    move_world(first, comparison->old_from_new);
    // Only a scale that was measured now makes the old facility's frame one of this map.
    if (first.map.frame == FrameKind::scaled && old.frame == FrameKind::facility) {
      first.map.frame = FrameKind::facility;
    }
    first.map.z_is_up = old.z_is_up;
    result.map.submaps.front() = first.map;
    return comparison;
  }
  return std::nullopt;
}

void append(std::vector<Finding> more, std::vector<Finding>& findings) {
  for (Finding& finding : more) findings.push_back(std::move(finding));
}

/// What an earlier map and a vehicle's quarantine lead to: the world kept, and findings.
std::vector<Finding> take_over(const References& references, const BuildCommandOptions& options,
                               bool with_family, BuildResult& result) {
  std::vector<Finding> findings;
  std::optional<FrameComparison> comparison;
  if (references.earlier) {
    comparison = take_frame_of(*references.earlier, references.quarantine, result);
    append(comparison ? frame_findings(*comparison, with_family)
                      : std::vector{frame_not_found(*options.frame_of)},
           findings);
  }
  if (references.quarantine) {
    append(quarantine_findings(*references.quarantine, result, comparison ? &*comparison : nullptr,
                               with_family),
           findings);
  }
  return findings;
}

/// Turns every sub-map so that z points up, but for those in the survey's frame, whose z is up, and
/// those whose markers don't tell: these are found, and stay as they are.
std::vector<Finding> level_submaps(LevelBy by, const Observations& observations,
                                   BuildResult& result) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    BuiltSubMap& submap = result.submaps[i];
    if (submap.map.z_is_up) continue;
    const auto level = level_world(
        submap, by, camera_up_in_world(submap, observations, result.estimate.calibration));
    if (level) {
      move_world(submap, *level);
      submap.map.z_is_up = true;
      result.map.submaps[i] = submap.map;
    } else {
      findings.push_back(not_levelled(i, submap.map.markers.size(), by));
    }
  }
  return findings;
}

/// Nothing that can't be a map goes on to the report or the file.
Status check_built(const BuildCommandOptions& options, const BuildResult& result) {
  const Status sound = check_map(result.map);
  if (sound) return {};
  return fail(ErrorKind::bad_data,
              "{}: what was built can't be a map: {}; check the markers' sizes, the rig, the "
              "detections and the world that it is put into; nothing written",
              options.input.paths.front().string(), sound.error().message);
}

/// All that a build found, but for its input.
std::vector<Finding> findings_of(const BuildCommandOptions& options, const BuildOptions& build,
                                 const References& references, const Observations& observations,
                                 DiagnosedBuild& diagnosed) {
  BuildResult& result = diagnosed.result;
  std::vector<Finding> findings = calibration_findings(result, observations, build);
  std::set<MarkerId> explained;
  for (const Finding& finding : diagnosed.findings) {
    explained.insert(finding.markers.begin(), finding.markers.end());
  }
  append(std::move(diagnosed.findings), findings);
  append(take_over(references, options, observations.several_families(), result), findings);
  if (options.level) append(level_submaps(*options.level, observations, result), findings);
  append(build_findings(result, observations, explained), findings);
  return findings;
}

/// Map, improved rigs and trajectories, each in its place.
Status write_results(const BuildCommandOptions& options, const BuildResult& result,
                     const Observations& observations, std::ostream& out, std::ostream& notes) {
  if (auto written = write_map_file(options.output, result.map); !written) return written;
  if (auto written = write_improved_rigs(options, result, observations, out, notes); !written) {
    return written;
  }
  if (!options.trajectory) return {};
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    auto written =
        write_trajectory(*options.trajectory, i, observations, result.submaps[i].trajectory);
    if (!written) return written;
  }
  return {};
}

Expected<ReportFolder> write_report(const BuildCommandOptions& options, const BuildResult& result,
                                    const Observations& observations,
                                    const std::vector<CaptureTruth>& truths,
                                    const std::vector<Finding>& findings) {
  Report report = report_of_build(result, observations, truths);
  report.findings = findings;
  report.survey = survey_of(result);
  report.map_name = options.output.filename().string();
  return ReportFolder::write(*options.report, report);
}

}  // namespace

Status run_build(const BuildCommandOptions& options, Progress& progress, std::ostream& out,
                 std::ostream& notes) {
  if (auto allowed = check_outputs(options); !allowed) return allowed;
  if (auto fine = options.build.check(); !fine) return fine;
  auto taken = take_captures_in(options.input, progress, notes);
  if (!taken) return tl::make_unexpected(taken.error());
  const auto references = read_references(options, only_stated_family(taken->captures));
  if (!references) return tl::make_unexpected(references.error());
  const auto truths =
      options.report ? read_truths(taken->captures, notes) : std::vector<CaptureTruth>{};
  const ObservationOptions observing{options.mono, options.input.detect.threads};
  auto made = make_observations(taken->captures, observing);
  if (!made) return tl::make_unexpected(made.error());
  std::vector<Finding> findings = std::move(taken->findings);
  append(baseline_findings(*made), findings);
  if (!options.mono) append(clock_findings(taken->captures), findings);
  findings = judged(std::move(findings), options.rules);
  if (!may_stand(findings, options.rules)) {
    print_findings(findings, notes);
    return tl::make_unexpected(
        refusal_of(options.output.string(), findings, "nothing was built of such input"));
  }
  if (auto any = check_any_seen(*made, options.input.paths.front()); !any) {
    print_findings(findings, notes);
    return any;
  }

  BuildOptions build = options.build;
  build.survey = references->survey;
  build.threads = options.input.detect.threads;
  const auto started = std::chrono::steady_clock::now();
  auto explained = build_explained(taken->captures, *std::move(made), observing, build, progress);
  if (!explained) return tl::make_unexpected(explained.error());
  build.survey = explained->survey;
  const Observations& observations = explained->observations;
  DiagnosedBuild& diagnosed = explained->diagnosed;
  BuildResult& result = diagnosed.result;
  append(explained->causes, findings);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started;
  if (result.submaps.empty()) {
    print_findings(findings, notes);
    return fail(ErrorKind::bad_data,
                "{}: no marker could be mapped: {} frame sets hold {} usable observations; check "
                "the family and the ids in markers.toml",
                options.input.paths.front().string(), observations.frame_sets.size(),
                observations.usable);
  }
  if (auto sound = check_built(options, result); !sound) {
    print_findings(findings, notes);
    return sound;
  }
  append(not_explained(findings_of(options, build, *references, observations, diagnosed),
                       explained->causes),
         findings);
  findings = judged(std::move(findings), options.rules);
  print_findings(findings, notes);
  // An earlier map's world, or a level one, may have moved it out of bounds.
  if (auto sound = check_built(options, result); !sound) return sound;

  std::optional<ReportFolder> report;
  if (options.report) {
    auto written = write_report(options, result, observations, truths, findings);
    if (!written) return tl::make_unexpected(written.error());
    report.emplace(std::move(*written));
  }
  const bool stands = may_stand(findings, options.rules);
  const fs::path rejected = rejected_path(options.output);
  if (auto written = stands ? write_results(options, result, observations, out, notes)
                            : write_map_file(rejected, result.map);
      !written) {
    return written;
  }
  if (stands) {
    if (auto written = write_info_of_build(options.output, observations, result, build); !written) {
      return written;
    }
  }
  if (report) {
    if (auto placed = report->put_in_place(); !placed) return placed;
  }
  print_summary(result, out);
  print_survey(result, out);
  print_line(out, "{}: map {}, built in {:.2f} s", (stands ? options.output : rejected).string(),
             content_hash(result.map), elapsed.count());
  if (options.report) {
    print_line(out, "{}: report", (*options.report / "index.html").string());
  }
  if (stands) return {};
  return tl::make_unexpected(refusal_of(options.output.string(), findings,
                                        fmt::format("the map went to {}", rejected.string())));
}

}  // namespace waymark
