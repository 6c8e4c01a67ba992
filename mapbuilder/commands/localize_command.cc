#include "mapbuilder/commands/localize_command.h"

#include <fmt/ostream.h>

#include "core/map/map_file.h"
#include "mapbuilder/mapping/relocalization.h"
#include "mapbuilder/mapping/trajectory_file.h"

namespace waymark {

Status run_localize(const LocalizeOptions& options, Progress& progress, std::ostream& out,
                    std::ostream& notes) {
  if (auto writable = check_writable(options.trajectory); !writable) return writable;
  const auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  auto captures = take_captures_in(options.input, progress, notes);
  if (!captures) return tl::make_unexpected(captures.error());
  auto table =
      make_observation_table(std::move(*captures), {options.mono, options.input.detect.threads});
  if (!table) return tl::make_unexpected(table.error());

  BuildOptions build = options.build;
  build.threads = options.input.detect.threads;
  const auto results = relocalize(*table, *map, build, progress);
  std::size_t observations = 0;
  for (const RelocalizedSubMap& result : results) observations += result.observations;
  if (observations == 0) {
    return fail(ErrorKind::bad_data,
                "{}: none of its {} observations is of a marker in {}; is it the right map?",
                options.input.paths.front().string(), table->observations.size(),
                options.map.string());
  }
  print_table_notes(*table, notes);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const RelocalizedSubMap& result = results[i];
    if (auto written = write_trajectory(options.trajectory, i, *table, result.trajectory);
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
