#include "mapbuilder/commands/build_command.h"

#include <fmt/ostream.h>

#include <chrono>

#include "core/map/map_file.h"
#include "mapbuilder/mapping/trajectory_file.h"

namespace waymark {
namespace {

/// "3, 7, 12" of at most `most` ids, then "… (40 in all)".
std::string list_ids(const std::vector<MarkerId>& ids, bool with_family, std::size_t most = 30) {
  std::string text;
  for (std::size_t i = 0; i < std::min(ids.size(), most); ++i) {
    text += (i > 0 ? ", " : "") + format_marker_id(ids[i], with_family);
  }
  if (ids.size() > most) text += fmt::format(", … ({} in all)", ids.size());
  return text;
}

void print_summary(const BuildResult& result, const ObservationTable& table, std::ostream& out) {
  const bool with_family = table.several_families();
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const BuiltSubMap& submap = result.submaps[i];
    fmt::print(out,
               "sub-map {}: {} markers, {} frame sets localized, {} ambiguous; {} observations, "
               "{} rejected; RMS {:.4f} px over accepted, {:.4f} px over all; corner sigma "
               "{:.3f} px\n",
               i, submap.map.markers.size(), submap.trajectory.size(), submap.ambiguous.size(),
               submap.observations, submap.rejected, submap.map.rms_px, submap.map.rms_all_px,
               submap.model_sigma_px);
    std::vector<MarkerId> unverified;
    for (const MapMarker& marker : submap.map.markers) {
      if (!marker.verified) unverified.push_back(marker.id);
    }
    if (!unverified.empty()) {
      fmt::print(out, "sub-map {}: one view, not verified: {}\n", i,
                 list_ids(unverified, with_family, 1000));
    }
  }
}

void print_warnings(const BuildResult& result, const ObservationTable& table, std::ostream& notes) {
  if (result.submaps.size() > 1) {
    fmt::print(notes,
               "warning: the captures fall into {} parts that share no markers; each is a sub-map "
               "with a frame of its own. Record a capture that sees markers of both parts to join "
               "them\n",
               result.submaps.size());
  }
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const BuiltSubMap& submap = result.submaps[i];
    if (!submap.settled) {
      fmt::print(notes,
                 "warning: sub-map {}: adjustment and gate did not come to rest; look at its "
                 "residuals before you trust it\n",
                 i);
    }
    if (!submap.covariances_known) {
      fmt::print(notes,
                 "warning: sub-map {}: the observations don't fix all markers against each other; "
                 "its covariances are unknown and stand as zero\n",
                 i);
    }
    if (submap.model_sigma_px >= kLargestModelSigma) {
      fmt::print(
          notes,
          "warning: sub-map {}: corners are {} px off and more; check rig.yaml, sizes and ids\n", i,
          kLargestModelSigma);
    }
  }
  if (!result.unmapped.empty()) {
    fmt::print(notes, "warning: seen but not mapped, no pose explains their views: {}\n",
               list_ids(result.unmapped, table.several_families()));
  }
  if (!result.unlocalized.empty()) {
    fmt::print(notes, "warning: {} frame sets see markers but could not be localized\n",
               result.unlocalized.size());
  }
  if (!result.without_markers.empty()) {
    fmt::print(notes, "note: {} frame sets see no usable marker\n", result.without_markers.size());
  }
  print_table_notes(table, notes);
}

}  // namespace

Status run_build(const BuildCommandOptions& options, Progress& progress, std::ostream& out,
                 std::ostream& notes) {
  if (auto writable = check_writable(options.output); !writable) return writable;
  if (options.trajectory) {
    if (auto writable = check_writable(*options.trajectory); !writable) return writable;
    if (std::filesystem::weakly_canonical(*options.trajectory) ==
        std::filesystem::weakly_canonical(options.output)) {
      return fail(ErrorKind::usage, "{}: named for both the map and the trajectory; name two files",
                  options.output.string());
    }
  }
  auto captures = take_captures_in(options.input, progress, notes);
  if (!captures) return tl::make_unexpected(captures.error());
  auto table =
      make_observation_table(std::move(*captures), {options.mono, options.input.detect.threads});
  if (!table) return tl::make_unexpected(table.error());

  BuildOptions build = options.build;
  build.threads = options.input.detect.threads;
  const auto started = std::chrono::steady_clock::now();
  const BuildResult result = build_map(*table, build, progress);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started;
  if (result.submaps.empty()) {
    return fail(ErrorKind::bad_data,
                "{}: no marker could be mapped: {} frame sets hold {} usable observations; check "
                "the family and the ids in markers.toml",
                options.input.paths.front().string(), table->frame_sets.size(),
                table->observations.size());
  }
  print_warnings(result, *table, notes);
  if (options.strict && result.submaps.size() > 1) {
    return fail(ErrorKind::bad_data, "{}: {} sub-maps, and --strict asks for one; nothing written",
                options.output.string(), result.submaps.size());
  }
  if (auto written = write_map_file(options.output, result.map); !written) return written;
  if (options.trajectory) {
    for (std::size_t i = 0; i < result.submaps.size(); ++i) {
      if (auto written =
              write_trajectory(*options.trajectory, i, *table, result.submaps[i].trajectory);
          !written) {
        return written;
      }
    }
  }
  print_summary(result, *table, out);
  fmt::print(out, "{}: map {}, built in {:.2f} s\n", options.output.string(),
             content_hash(result.map), elapsed.count());
  return {};
}

}  // namespace waymark
