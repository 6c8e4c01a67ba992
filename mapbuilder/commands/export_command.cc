#include "mapbuilder/commands/export_command.h"

#include <functional>

#include "core/base/atomic_file.h"
#include "core/base/notes.h"
#include "core/base/output_check.h"
#include "core/map/map_export.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "mapbuilder/build/output_paths.h"
#include "mapbuilder/commands/print_line.h"

namespace waymark {
namespace {

using SubMapFormat = std::function<std::string(const SubMap&, bool with_family)>;

/// nullptr for an unknown format.
SubMapFormat submap_format(const std::string& name) {
  if (name == "tum") return format_submap_tum;
  if (name == "csv") return format_submap_csv;
  if (name == "ply") return [](const SubMap& submap, bool) { return format_submap_ply(submap); };
  return nullptr;
}

}  // namespace

Status run_export(const ExportOptions& options, std::ostream& notes) {
  const SubMapFormat format = submap_format(options.format);
  if (!format && options.format != "json") {
    return fail(ErrorKind::usage, "unknown format '{}'; known are tum, json, csv, ply",
                options.format);
  }
  if (auto writable = check_writable(options.output); !writable) return writable;
  const auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  const std::size_t files = format ? map->submaps.size() : 1;
  for (std::size_t i = 0; i < files; ++i) {
    auto spares = check_spares(path_of_submap(options.output, i), {options.map});
    if (!spares) return spares;
  }
  if (!format) return write_file_atomically(options.output, format_map_json(*map));
  std::vector<std::string> places;
  for (std::size_t i = 0; i < map->submaps.size(); ++i) {
    const std::filesystem::path path = path_of_submap(options.output, i);
    auto status = write_file_atomically(path, format(map->submaps[i], map->several_families()));
    if (!status) return status;
    if (i > 0) places.push_back(fmt::format("sub-map {} is in {}", i, path.string()));
  }
  for (const std::string& place : shown_notes(places)) print_line(notes, "{}", place);
  return {};
}

}  // namespace waymark
