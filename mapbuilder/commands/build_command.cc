#include "mapbuilder/commands/build_command.h"

#include <fmt/ostream.h>

#include <chrono>

#include "core/base/atomic_file.h"
#include "core/base/same_file.h"
#include "core/camera/kalibr.h"
#include "core/map/map_check.h"
#include "core/map/map_file.h"
#include "core/map/quarantine.h"
#include "mapbuilder/build/output_paths.h"
#include "mapbuilder/build/trajectory_file.h"
#include "mapbuilder/diagnosis/build_findings.h"
#include "mapbuilder/diagnosis/calibration_findings.h"
#include "mapbuilder/diagnosis/diagnosed_build.h"
#include "mapbuilder/diagnosis/frame_findings.h"
#include "mapbuilder/diagnosis/quarantine_findings.h"
#include "mapbuilder/report/report_folder.h"
#include "mapbuilder/report/report_of_build.h"

namespace waymark {
namespace {

void print_summary(const BuildResult& result, std::ostream& out) {
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const BuiltSubMap& submap = result.submaps[i];
    fmt::print(out,
               "sub-map {}: {} markers, {} frame sets localized, {} ambiguous; {} observations, "
               "{} rejected; RMS {:.4f} px over accepted, {:.4f} px over all; corner sigma "
               "{:.3f} px\n",
               i, submap.map.markers.size(), submap.trajectory.size(), submap.ambiguous.size(),
               submap.observations, submap.rejected, submap.map.rms_px, submap.map.rms_all_px,
               submap.model_sigma_px);
  }
}

void print_survey(const BuildResult& result, std::ostream& out) {
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    for (const SurveyResidual& entry : result.submaps[i].survey) {
      if (!entry.mapped) continue;
      fmt::print(out, "sub-map {}: survey {}: {}: off by {:+.2f} mm ({:.1f} sigma)\n", i,
                 entry.use == SurveyUse::fit ? "fit" : "check", entry.entry, entry.residual_m * 1e3,
                 entry.residual_m / entry.sigma_m);
    }
  }
}

/// The survey as the report shows it, against the first sub-map.
std::vector<ReportSurveyEntry> survey_of(const BuildResult& result) {
  std::vector<ReportSurveyEntry> entries;
  for (const SurveyResidual& residual : result.submaps.front().survey) {
    ReportSurveyEntry entry;
    entry.entry = residual.entry;
    entry.markers = residual.markers;
    entry.is_point = residual.point;
    entry.check = residual.use == SurveyUse::check;
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

/// The family that a bare number means; nullopt where several meet.
std::optional<Family> only_family_of(const ObservationTable& table) {
  if (table.several_families() || table.markers.empty()) return std::nullopt;
  return table.markers.front().family;
}

/// Where the first refined rig goes: as asked for, else MAP's name with .yaml; nullopt when none is
/// refined.
std::optional<std::filesystem::path> refined_rig_path(const BuildCommandOptions& options) {
  if (!options.build.refine.extrinsics && !options.build.refine.intrinsics) return std::nullopt;
  return options.refined_rig.value_or(
      std::filesystem::path(options.output).replace_extension(".yaml"));
}

/// Fails when the refined rig could not be written, or would take the place of another file of this
/// build: the user's calibration above all.
Status check_refined_rig_path(const BuildCommandOptions& options) {
  const auto path = refined_rig_path(options);
  if (!path) return {};
  if (auto writable = check_writable(*path); !writable) return writable;
  std::vector<std::filesystem::path> taken{options.output};
  if (options.trajectory) taken.push_back(*options.trajectory);
  if (options.input.rig_yaml) taken.push_back(*options.input.rig_yaml);
  for (const auto& capture : options.input.paths) taken.push_back(capture / "rig.yaml");
  for (const auto& file : taken) {
    if (!is_same_file(file, *path)) continue;
    return fail(ErrorKind::usage,
                "{}: the refined rig would take its place; name another with --refined-rig",
                path->string());
  }
  return {};
}

/// The refined rigs as camchains, numbered from the second on.
Status write_refined_rigs(const std::filesystem::path& first, const ObservationTable& table,
                          std::ostream& out) {
  for (std::size_t i = 0; i < table.rigs.size(); ++i) {
    const std::filesystem::path path = i == 0 ? first : path_beside(first, std::to_string(i));
    if (auto written = write_file_atomically(path, format_camchain(table.rigs[i])); !written) {
      return written;
    }
    fmt::print(out, "{}: refined rig\n", path.string());
  }
  return {};
}

/// What is known to be true of the captures: folders groundtruth, where they are there. One that
/// can't be read is no reason to build no map.
std::vector<CaptureTruth> read_truths(const std::vector<DetectedCapture>& captures,
                                      std::ostream& notes) {
  std::vector<CaptureTruth> truths;
  for (const DetectedCapture& capture : captures) {
    const auto folder = std::filesystem::path(capture.name) / "groundtruth";
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored)) continue;
    auto truth = read_ground_truth(folder, capture.catalog.only_family());
    if (!truth) {
      fmt::print(notes, "note: {}; the report shows no truth\n", truth.error().message);
    } else if (truth->world_from_rig) {
      truths.push_back({capture.name, capture.rig, *std::move(truth->world_from_rig)});
    }
  }
  return truths;
}

/// Lays the result into the world of an earlier map, its first sub-map into the first that fits,
/// by markers that are not in quarantine; nullopt when none fits.
std::optional<FrameComparison> take_frame_of(const MarkerMap& earlier,
                                             const std::optional<Quarantine>& quarantine,
                                             BuildResult& result) {
  const std::set<MarkerId> suspects =
      quarantine ? moved_markers(*quarantine) : std::set<MarkerId>{};
  for (const SubMap& old : earlier.submaps) {
    const auto comparison = compare_frames(result.submaps.front().map, old, suspects);
    if (!comparison) continue;
    move_world(result.submaps.front(), comparison->old_from_new);
    result.submaps.front().map.frame = old.frame;
    result.submaps.front().map.z_is_up = old.z_is_up;
    result.map.submaps.front() = result.submaps.front().map;
    return comparison;
  }
  return std::nullopt;
}

/// What an earlier map and a vehicle's quarantine lead to: the world kept, and findings.
std::vector<Finding> take_over(const std::optional<MarkerMap>& earlier,
                               const std::optional<Quarantine>& quarantine, BuildResult& result) {
  std::vector<Finding> findings;
  std::optional<FrameComparison> comparison;
  if (earlier) {
    comparison = take_frame_of(*earlier, quarantine, result);
    findings = comparison ? frame_findings(*comparison) : std::vector{frame_not_found()};
  }
  if (quarantine) {
    for (Finding& finding :
         quarantine_findings(*quarantine, result, comparison ? &*comparison : nullptr)) {
      findings.push_back(std::move(finding));
    }
  }
  return findings;
}

/// Turns every sub-map so that z points up, but for those in the survey's frame, whose z is up.
/// Error: bad_data where the markers don't tell.
Status level_maps(LevelBy by, const ObservationTable& table, BuildResult& result) {
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    BuiltSubMap& submap = result.submaps[i];
    if (submap.map.z_is_up) continue;
    const auto level = level_world(submap, by, camera_up_in_world(submap, table));
    if (!level) {
      return fail(ErrorKind::bad_data,
                  "--level: sub-map {}: its {} markers don't tell where up is: by walls it takes "
                  "walls that face different ways, by floor at least 2 markers; nothing written",
                  i, submap.map.markers.size());
    }
    move_world(submap, *level);
    submap.map.z_is_up = true;
    result.map.submaps[i] = submap.map;
  }
  return {};
}

}  // namespace

Status run_build(const BuildCommandOptions& options, Progress& progress, std::ostream& out,
                 std::ostream& notes) {
  if (auto writable = check_writable(options.output); !writable) return writable;
  if (options.report) {
    if (auto allowed = check_report_folder(*options.report); !allowed) return allowed;
  }
  if (options.trajectory) {
    if (auto writable = check_writable(*options.trajectory); !writable) return writable;
    if (is_same_file(*options.trajectory, options.output)) {
      return fail(ErrorKind::usage, "{}: named for both the map and the trajectory; name two files",
                  options.output.string());
    }
  }
  if (auto allowed = check_refined_rig_path(options); !allowed) return allowed;
  auto captures = take_captures_in(options.input, progress, notes);
  if (!captures) return tl::make_unexpected(captures.error());
  const auto truths = options.report ? read_truths(*captures, notes) : std::vector<CaptureTruth>{};
  auto table =
      make_observation_table(std::move(*captures), {options.mono, options.input.detect.threads});
  if (!table) return tl::make_unexpected(table.error());

  BuildOptions build = options.build;
  std::optional<MarkerMap> earlier;
  if (options.frame_of) {
    auto map = read_map_file(*options.frame_of);
    if (!map) return tl::make_unexpected(map.error());
    earlier = *std::move(map);
  }
  std::optional<Quarantine> quarantine;
  if (options.quarantine) {
    auto read = earlier ? read_quarantine_of(*options.quarantine, *earlier, *options.frame_of)
                        : read_quarantine(*options.quarantine);
    if (!read) return tl::make_unexpected(read.error());
    quarantine = *std::move(read);
  }
  if (options.survey) {
    auto survey = read_survey(*options.survey, only_family_of(*table));
    if (!survey) return tl::make_unexpected(survey.error());
    build.survey = *std::move(survey);
  }
  build.threads = options.input.detect.threads;
  const auto started = std::chrono::steady_clock::now();
  DiagnosedBuild diagnosed = build_and_diagnose(*table, build, {}, progress);
  BuildResult& result = diagnosed.result;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started;
  if (result.submaps.empty()) {
    return fail(ErrorKind::bad_data,
                "{}: no marker could be mapped: {} frame sets hold {} usable observations; check "
                "the family and the ids in markers.toml",
                options.input.paths.front().string(), table->frame_sets.size(),
                table->observations.size());
  }
  std::vector<Finding> findings = calibration_findings(result, *table, build);
  for (Finding& finding : diagnosed.findings) findings.push_back(std::move(finding));
  for (Finding& finding : take_over(earlier, quarantine, result)) {
    findings.push_back(std::move(finding));
  }
  if (options.level) {
    if (auto levelled = level_maps(*options.level, *table, result); !levelled) return levelled;
  }
  if (auto sound = check_map(result.map); !sound) {
    return fail(ErrorKind::bad_data,
                "{}: what was built can't be a map: {}; check the markers' sizes, the rig and the "
                "detections; nothing written",
                options.input.paths.front().string(), sound.error().message);
  }
  for (Finding& finding : build_findings(result, *table)) findings.push_back(std::move(finding));
  for (const Finding& finding : findings) {
    fmt::print(notes, "{}\n", one_line(finding, table->several_families()));
  }
  if (options.strict && result.submaps.size() > 1) {
    return fail(ErrorKind::bad_data, "{}: {} sub-maps, and --strict asks for one; nothing written",
                options.output.string(), result.submaps.size());
  }
  std::optional<ReportFolder> report_folder;
  if (options.report) {
    Report report = report_of_build(result, *table, truths);
    report.findings = findings;
    report.survey = survey_of(result);
    report.map_name = options.output.filename().string();
    auto written = ReportFolder::write(*options.report, report);
    if (!written) return tl::make_unexpected(written.error());
    report_folder.emplace(std::move(*written));
  }
  if (auto written = write_map_file(options.output, result.map); !written) return written;
  if (const auto path = refined_rig_path(options); path && result.calibration.refined) {
    if (auto written = write_refined_rigs(*path, *table, out); !written) return written;
  }
  if (options.trajectory) {
    for (std::size_t i = 0; i < result.submaps.size(); ++i) {
      if (auto written =
              write_trajectory(*options.trajectory, i, *table, result.submaps[i].trajectory);
          !written) {
        return written;
      }
    }
  }
  if (report_folder) {
    if (auto placed = report_folder->put_in_place(); !placed) return placed;
  }
  print_summary(result, out);
  print_survey(result, out);
  fmt::print(out, "{}: map {}, built in {:.2f} s\n", options.output.string(),
             content_hash(result.map), elapsed.count());
  if (options.report) {
    fmt::print(out, "{}: report\n", (*options.report / "index.html").string());
  }
  return {};
}

}  // namespace waymark
